#include "cw2-bake/base/file_finder.h"

#include <wctype.h>

#include <algorithm>
#include <clocale>
#include <numeric>
#include <system_error>
#include <utility>

namespace bake {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
    std::error_code ignored;
    return fs::exists(path, ignored);
}

bool is_file(const fs::path& path) {
    std::error_code ignored;
    return fs::exists(path, ignored) && !fs::is_directory(path, ignored);
}

/// The number of bytes of the UTF-8 character at the start of `text`, and its code; 1 and the byte
/// itself if there is none.
std::pair<std::size_t, wint_t> first_character(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const std::size_t length = byte(0) < 0xC2   ? 1
                               : byte(0) < 0xE0 ? 2
                               : byte(0) < 0xF0 ? 3
                               : byte(0) < 0xF5 ? 4
                                                : 1;
    if (length == 1 || length > text.size()) return {1, byte(0)};
    wint_t code = byte(0) & (0x7Fu >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if (byte(i) >> 6 != 2) return {1, byte(0)};
        code = code << 6 | (byte(i) & 0x3Fu);
    }
    return {length, code};
}

/// `name` in small letters, as a key: equal for names that differ in case alone.
std::string folded(std::string_view name) {
    static const locale_t unicode = ::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
    std::string result;
    while (!name.empty()) {
        const auto [length, code] = first_character(name);
        if (length == 1) {
            const char c = name.front();
            result += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        } else {
            const wint_t small = unicode ? ::towlower_l(code, unicode) : code;
            result += '\0';
            result.append(reinterpret_cast<const char*>(&small), sizeof small);
        }
        name.remove_prefix(length);
    }
    return result;
}

std::string last_component(const std::string& name) {
    return name.substr(name.rfind('/') + 1);
}

/// How many letters must be put in, taken out or exchanged to make one of the other (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t exchanged = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({exchanged, diagonal + 1, row[j] + 1});
        }
    }
    return row.back();
}

}  // namespace

std::vector<std::string> readings_of(std::string_view name) {
    std::vector<std::string> readings{std::string(name)};
    std::ranges::replace(readings[0], '\\', '/');
    if (readings[0] != name) readings.emplace_back(name);
    return readings;
}

FileFinder::FileFinder(const fs::path& root) {
    std::error_code error;
    if (!root.empty()) root_ = fs::canonical(root, error);
    if (error) root_ = root;
}

bool FileFinder::may_look_at(const fs::path& path) const {
    if (root_.empty()) return true;
    std::error_code error;
    const fs::path absolute = fs::absolute(path, error);
    const fs::path real = fs::weakly_canonical(absolute, error);
    return !error && std::ranges::mismatch(root_, real).in1 == root_.end();
}

const FileFinder::Listing& FileFinder::list(const fs::path& folder) {
    static const Listing kEmpty;
    const auto known = listings_.find(folder);
    if (known != listings_.end()) return known->second;
    if (entries_left_ == 0 || !may_look_at(folder.empty() ? "." : folder)) return kEmpty;
    entries_left_ -= std::min(entries_left_, kEntriesOfFolder);
    Listing& listing = listings_[folder];
    std::error_code error;
    fs::directory_iterator at(folder.empty() ? "." : folder, error);
    for (; !error && at != fs::directory_iterator(); at.increment(error)) {
        if (entries_left_ == 0) {
            listing.names.clear();  // a part of them would depend on their order
            break;
        }
        --entries_left_;
        listing.names.push_back(at->path().filename().string());
    }
    std::ranges::sort(listing.names);
    for (std::size_t i = 0; i < listing.names.size(); ++i)
        listing.by_folded.emplace(folded(listing.names[i]), i);
    return listing;
}

/// The one file that differs from `name` in the case of its components, if at all; else empty.
fs::path FileFinder::in_another_case(const fs::path& folder, const std::string& name) {
    constexpr std::size_t kMostPaths = 16;
    const fs::path path(name);
    std::vector<fs::path> paths{path.is_absolute() ? path.root_path() : folder};
    for (const fs::path& component : path.relative_path()) {
        if (component.empty() || component == ".") continue;
        if (component == "..") {
            for (fs::path& parent : paths) parent /= component;
            continue;
        }
        std::vector<fs::path> next;
        for (const fs::path& parent : paths) {
            const Listing& listing = list(parent);
            const auto [begin, end] = listing.by_folded.equal_range(folded(component.native()));
            for (auto at = begin; at != end; ++at)
                next.push_back(parent / listing.names[at->second]);
        }
        if (next.size() > kMostPaths) return {};
        paths = std::move(next);
    }
    std::erase_if(paths,
                  [this](const fs::path& found) { return !may_look_at(found) || !is_file(found); });
    return paths.size() == 1 ? paths.front() : fs::path();
}

/// The files beside `named` that have its stem, or a name that differs in few letters.
std::string FileFinder::near_misses(const fs::path& named) {
    constexpr std::size_t kMostNamed = 3;
    const std::string name = folded(named.filename().native());
    const std::string stem = folded(named.stem().native());
    const std::size_t limit = std::clamp<std::size_t>(name.size() / 4, 1, 4);
    std::vector<std::pair<std::size_t, std::string>> found;
    for (const std::string& other : list(named.parent_path()).names) {
        const std::string key = folded(other);
        const bool same_stem = folded(fs::path(other).stem().native()) == stem;
        const std::size_t longer = std::max(name.size(), key.size());
        const bool close = longer - std::min(name.size(), key.size()) <= limit;
        const std::size_t letters = 64 + (close ? name.size() * key.size() : 0);
        if (letters > comparisons_left_) break;
        comparisons_left_ -= letters;
        const std::size_t distance = close ? edit_distance(name, key) : longer;
        if (same_stem || distance <= limit) found.emplace_back(same_stem ? 0 : distance, other);
    }
    std::ranges::stable_sort(found, {}, [](const auto& entry) { return entry.first; });
    std::string note;
    for (std::size_t i = 0; i < std::min(found.size(), kMostNamed); ++i)
        note += (i == 0 ? "there is " : ", ") + found[i].second;
    return note;
}

FoundFile FileFinder::find(const fs::path& folder, std::span<const std::string> readings) {
    bool is_outside = false;
    for (const std::string& reading : readings) {
        const bool may_look = may_look_at(folder / reading);
        if (may_look && is_there(folder / reading)) return {folder / reading, true};
        is_outside = is_outside || !may_look;
    }
    constexpr std::string_view kOutside = "it is outside the scene's folder";
    // Nobody names a file like this, and to look for it takes time.
    constexpr std::ptrdiff_t kMostFolders = 64;
    if (std::ranges::count(readings.front(), '/') > kMostFolders)
        return {folder / readings.front(), false, std::string(is_outside ? kOutside : ""),
                is_outside};
    const auto taken = [](const fs::path& file) {
        return FoundFile{file, true, file.string() + " is taken"};
    };
    for (const std::string& reading : readings) {
        const fs::path file = in_another_case(folder, reading);
        if (!file.empty()) return taken(file);
    }
    for (const std::string& reading : readings) {
        const std::string last = last_component(reading);
        if (last.empty() || last == reading) continue;
        if (may_look_at(folder / last) && is_file(folder / last)) return taken(folder / last);
        const fs::path file = in_another_case(folder, last);
        if (!file.empty()) return taken(file);
    }
    const fs::path named = folder / readings.front();
    if (is_outside) return {named, false, std::string(kOutside), true};
    std::string note = near_misses(named);
    const std::string last = last_component(readings.front());
    if (note.empty() && last != readings.front()) note = near_misses(folder / last);
    return {named, false, note};
}

}  // namespace bake
