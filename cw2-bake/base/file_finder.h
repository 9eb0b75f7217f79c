// Finds the files that a scene names: names come from other systems, and from other people's disks.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace bake {

struct FoundFile {
    std::filesystem::path file;  ///< what is there; or, where nothing is, what was named
    bool exists = false;
    /// For a message: "X is taken" where another file stands in, "there is X" where none does, but
    /// some have a similar name; else empty.
    std::string note{};
    bool is_outside = false;  ///< it was not looked for: it is beyond where a finder may look
};

/// Keeps what it learns of folders while it lives. It looks at no more than kMostEntries entries of
/// folders, of which each counts as kEntriesOfFolder more, and then only for files as they are
/// named.
class FileFinder {
 public:
    static constexpr std::size_t kMostEntries = 200'000, kEntriesOfFolder = 16;

    /// Looks anywhere, or only in the folder `root` and what it holds, also behind symbolic links.
    explicit FileFinder(const std::filesystem::path& root = {});

    /// The file that something in `folder` names. In this order: one of the `readings` of the name
    /// (relative to `folder`, or absolute), the likeliest first; one of them in another case, where
    /// exactly one file has it; its last component in `folder`, also in another case. A folder is
    /// taken only where it is named exactly. What is outside of the root is not there.
    FoundFile find(const std::filesystem::path& folder, std::span<const std::string> readings);

 private:
    struct Listing {
        std::vector<std::string> names;  ///< sorted
        std::unordered_multimap<std::string, std::size_t> by_folded;
    };
    const Listing& list(const std::filesystem::path& folder);
    std::filesystem::path in_another_case(const std::filesystem::path& folder,
                                          const std::string& name);
    std::string near_misses(const std::filesystem::path& named);
    bool may_look_at(const std::filesystem::path& path) const;

    std::filesystem::path root_;  ///< without links; empty: anywhere
    std::map<std::filesystem::path, Listing> listings_;
    std::size_t entries_left_ = kMostEntries;
    std::size_t comparisons_left_ = 8'000'000;  ///< of letters
};

/// How an OBJ or MTL may mean a name: backslashes separate folders, or belong to it.
std::vector<std::string> readings_of(std::string_view name);

}  // namespace bake
