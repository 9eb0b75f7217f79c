#include "cw2/source_bake.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pty.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "common/file_stamp.h"
#include "common/io.h"
#include "common/program.h"
#include "common/signals.h"
#include "cw2/options/frame_of.h"
#include "mesh-format/file.h"

namespace cw2 {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kCacheBytes = std::uintmax_t{2} << 30;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
    throw common::FileError(path.string() + ": " + what);
}

/// Empty where there is no place for one.
fs::path cache_folder() {
    const auto absolute = [](const char* variable) {
        const char* const value = std::getenv(variable);
        return value && *value == '/' ? fs::path(value) : fs::path();
    };
    fs::path folder = absolute("XDG_CACHE_HOME");
    if (folder.empty()) {
        folder = absolute("HOME");
        if (folder.empty()) return {};
        folder /= ".cache";
    }
    return folder / "cw2";
}

/// What changes with a file's contents, as text.
std::string stamp_of(const fs::path& path) {
    const std::optional<common::FileStamp> stamp = common::stamp_of(path);
    if (!stamp) return "missing";
    return fmt::format("{}.{:09} {} {}", stamp->seconds, stamp->nanoseconds, stamp->size,
                       stamp->inode);
}

/// Files are given the time of the last tick, of which there are 100 a second at least.
std::chrono::system_clock::time_point now_for_files() {
    return std::chrono::system_clock::now() - std::chrono::milliseconds(10);
}

std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Names as cw2-bake writes them behind the colon of a depfile's first rule.
std::vector<fs::path> inputs_of(const std::string& depfile) {
    std::vector<fs::path> inputs;
    std::string name;
    bool behind_colon = false;
    const auto end_name = [&] {
        if (behind_colon && !name.empty()) inputs.emplace_back(name);
        name.clear();
    };
    for (std::size_t i = 0; i < depfile.size() && depfile[i] != '\n'; ++i) {
        const char c = depfile[i];
        const char next = i + 1 < depfile.size() ? depfile[i + 1] : '\n';
        if (c == '\\' && next == '\n') {
            end_name();
            ++i;
        } else if ((c == '\\' && (next == ' ' || next == '#' || next == ':')) ||
                   (c == '$' && next == '$')) {
            name += next;
            ++i;
        } else if (c == ':' && !behind_colon) {
            name.clear();
            behind_colon = true;
        } else if (c == ' ') {
            end_name();
        } else {
            name += c;
        }
    }
    end_name();
    return inputs;
}

/// Both ends of a terminal, so that cw2-bake shows how far it is; of a pipe where there is none.
std::array<int, 2> open_channel() {
    std::array<int, 2> ends{-1, -1};
    termios raw{};
    ::cfmakeraw(&raw);
    if (::openpty(&ends[0], &ends[1], nullptr, &raw, nullptr) != 0 && ::pipe(ends.data()) != 0)
        throw common::FileError("cw2-bake: cannot be run: " +
                                std::generic_category().message(errno));
    for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);
    return ends;
}

[[noreturn]] void become(const std::vector<std::string>& command, int output) {
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    const int nothing = ::open("/dev/null", O_RDWR);
    if (nothing < 0 || ::dup2(nothing, STDIN_FILENO) < 0 || ::dup2(nothing, STDOUT_FILENO) < 0 ||
        ::dup2(output, STDERR_FILENO) < 0)
        ::_exit(127);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
}

constexpr std::string_view kPrefix = "cw2-bake: ";

}  // namespace

SourceBake::SourceBake(const fs::path& source, const BakeSettings& settings,
                       std::function<void(const std::string&)> tell)
    : source_(fs::absolute(source)),
      folder_as_given_(source.is_relative() ? fs::current_path() / "" : fs::path()),
      baker_(common::beside_program("cw2-bake")),
      tell_(std::move(tell)) {
    const common::MappedFile exists(source);
    if (::access(baker_.c_str(), X_OK) != 0)
        fail(source, fmt::format("is not baked yet, and there is no cw2-bake beside cw2 ({})",
                                 baker_.string()));
    options_ = {"--textures", settings.uncompressed ? "lossless" : "bc"};
    if (settings.z_up) options_.insert(options_.end(), {"--up", "z"});
    if (settings.strict) options_.emplace_back("--strict");
    if (settings.restricted) options_.emplace_back("--restrict");
    key_ =
        fmt::format("{}\n{}\n{}\n", source_.string(), fmt::join(options_, " "), stamp_of(baker_));
    folder_ = cache_folder();
    std::error_code error;
    if (!folder_.empty()) fs::create_directories(folder_, error);
    if (folder_.empty() || ::access(folder_.c_str(), W_OK) != 0) {
        std::string name = (fs::temp_directory_path() / "cw2-XXXXXX").string();
        if (!::mkdtemp(name.data())) fail(name, std::generic_category().message(errno));
        folder_ = name;
        is_temporary_ = true;
    }
    const auto bytes = std::as_bytes(std::span(key_));
    baked_ = folder_ /
             fmt::format("{:016x}.cw2mesh", mesh_format::checksum({bytes.data(), bytes.size()}));
    if (is_temporary_)
        for (const fs::path& path : {folder_, baked_, depfile()})
            common::note_temporary(path.string());
}

SourceBake::~SourceBake() {
    if (process_ > 0) {
        ::kill(process_, SIGTERM);
        while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) continue;
        common::note_child(0);
    }
    if (output_ >= 0) ::close(output_);
    if (lock_ >= 0) ::close(lock_);
    if (is_temporary_)
        for (const fs::path& path : {depfile(), baked_, folder_})
            common::remove_temporary(path.string());
}

fs::path SourceBake::depfile() const {
    return fs::path(baked_).replace_extension("d");
}

bool SourceBake::done(std::chrono::milliseconds patience) {
    if (is_done_) return true;
    if (process_ < 0) {
        if (!lock()) {
            ::usleep(static_cast<useconds_t>(std::min<std::int64_t>(patience.count(), 50) * 1000));
            return false;
        }
        if (!reuse()) start();
    }
    if (process_ > 0) {
        if (!read_output(patience)) return false;
        if (!finish()) return false;
    }
    if (lock_ >= 0) ::close(std::exchange(lock_, -1));
    return is_done_ = true;
}

/// Whether nobody else is at work on the same entry.
bool SourceBake::lock() {
    if (is_temporary_ || lock_ >= 0) return true;
    lock_ = ::open(fs::path(baked_).replace_extension("lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC,
                   0666);
    if (lock_ < 0) fail(baked_, "cannot be locked: " + std::generic_category().message(errno));
    if (::flock(lock_, LOCK_EX | LOCK_NB) == 0) return true;
    ::close(std::exchange(lock_, -1));
    return false;
}

/// The notes beside an entry: the key, how many inputs there are, each one's stamp and name, and
/// what cw2-bake said.
bool SourceBake::reuse() {
    if (is_temporary_ || ::access(baked_.c_str(), R_OK) != 0) return false;
    const std::string notes = text_of(fs::path(baked_).replace_extension("notes"));
    if (!notes.starts_with(key_)) return false;
    std::vector<std::string> lines;
    for (std::size_t at = key_.size(); at < notes.size();) {
        const std::size_t end = std::min(notes.find('\n', at), notes.size());
        lines.push_back(notes.substr(at, end - at));
        at = end + 1;
    }
    read_at_ = now_for_files();
    std::size_t i = 0;
    for (; i < lines.size() && !lines[i].empty(); ++i) {
        const std::size_t tab = std::min(lines[i].find('\t'), lines[i].size() - 1);
        const fs::path path = lines[i].substr(tab + 1);
        if (stamp_of(path) != lines[i].substr(0, tab)) return false;
        sources_.push_back(path);
    }
    if (sources_.empty()) return false;
    for (++i; i < lines.size(); ++i) tell_(as_given(lines[i]));
    ::utimensat(AT_FDCWD, baked_.c_str(), nullptr, 0);
    return true;
}

void SourceBake::start() {
    sources_.clear();
    std::vector<std::string> command{baker_.string(), source_.string(), "-o", baked_.string()};
    if (has_depfile_) command.insert(command.end(), {"--depfile", depfile().string()});
    command.insert(command.end(), options_.begin(), options_.end());
    const std::array<int, 2> ends = open_channel();
    read_at_ = now_for_files();
    process_ = ::fork();
    if (process_ == 0) become(command, ends[1]);
    if (process_ > 0) common::note_child(process_);
    ::close(ends[1]);
    output_ = ends[0];
    if (process_ < 0) fail(baker_, "cannot be started: " + std::generic_category().message(errno));
}

/// True once cw2-bake has ended.
bool SourceBake::read_output(std::chrono::milliseconds patience) {
    pollfd waiting{.fd = output_, .events = POLLIN, .revents = 0};
    while (::poll(&waiting, 1, static_cast<int>(patience.count())) > 0) {
        patience = std::chrono::milliseconds(0);
        std::array<char, 4096> bytes;
        const ssize_t count = ::read(output_, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return true;  // a terminal whose other end is closed gives an error
        take({bytes.data(), static_cast<std::size_t>(count)});
    }
    return false;
}

/// A message of cw2-bake's, which is given an absolute path, with paths as the user gave them.
std::string SourceBake::as_given(std::string line) const {
    const std::string& folder = folder_as_given_.native();
    if (folder.size() <= 1) return line;
    for (std::size_t at = 0; (at = line.find(folder, at)) != std::string::npos;) {
        const bool begins =
            at == 0 || std::string_view(" '\"(").find(line[at - 1]) != std::string_view::npos;
        if (begins)
            line.erase(at, folder.size());
        else
            at += folder.size();
    }
    return line;
}

/// Lines end in a line feed; what a carriage return or an escape sequence begins is the progress.
void SourceBake::take(std::string_view text) {
    for (const char c : text) {
        if (c == '\n') {
            progress_.clear();
            lines_.push_back(std::exchange(text_, {}));
            if (!lines_.back().starts_with(kPrefix) ||
                lines_.back().find("warning: ") != std::string::npos)
                tell_(as_given(lines_.back()));
        } else if (c == '\r' || (text_ == "\033[" && c == 'K')) {
            text_.clear();
        } else {
            text_ += c;
        }
    }
    if (text_.starts_with('[')) progress_ = text_;
}

/// False where it was started again.
bool SourceBake::finish() {
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
    process_ = -1;
    common::note_child(0);
    ::close(std::exchange(output_, -1));
    progress_.clear();
    if (!WIFEXITED(status))
        fail(as_given(source_.string()),
             fmt::format("cw2-bake was ended by signal {}", WTERMSIG(status)));
    if (WEXITSTATUS(status) != 0) {
        const std::string last = lines_.empty() ? "cw2-bake cannot be started" : lines_.back();
        // Names that a depfile cannot hold; without one the next run bakes again.
        if (has_depfile_ && last.find("--depfile: ") != std::string::npos) {
            has_depfile_ = false;
            lines_.clear();
            start();
            return false;
        }
        throw common::FileError(
            as_given(last.starts_with(kPrefix) ? last.substr(kPrefix.size()) : last));
    }
    sources_ = has_depfile_ ? inputs_of(text_of(depfile())) : std::vector{source_};
    if (is_temporary_) return true;
    if (has_depfile_) note_sources();
    remove_old_entries();
    return true;
}

/// Not where a source may have changed after it was read: then the next run bakes again.
void SourceBake::note_sources() {
    std::string notes = key_;
    for (const fs::path& path : sources_) {
        const std::optional<common::FileStamp> stamp = common::stamp_of(path);
        if (path.string().find('\n') != std::string::npos ||
            (stamp && stamp->written_at() >= read_at_))
            return;
        notes += stamp_of(path) + '\t' + path.string() + '\n';
    }
    notes += '\n';
    for (const std::string& line : lines_) notes += line + '\n';
    common::write_file(fs::path(baked_).replace_extension("notes"),
                       std::as_bytes(std::span(notes)));
}

void SourceBake::remove_old_entries() const {
    struct Entry {
        fs::file_time_type used;
        std::uintmax_t bytes;
        fs::path path;
    };
    std::vector<Entry> entries;
    std::uintmax_t bytes = 0;
    std::error_code error;
    for (const fs::directory_entry& file : fs::directory_iterator(folder_, error)) {
        if (file.path().extension() != ".cw2mesh") continue;
        entries.push_back({file.last_write_time(error), file.file_size(error), file.path()});
        bytes += entries.back().bytes;
    }
    std::ranges::sort(entries, {}, &Entry::used);
    for (const Entry& entry : entries) {
        if (bytes <= kCacheBytes) return;
        if (entry.path == baked_) continue;
        const fs::path lock_file = fs::path(entry.path).replace_extension("lock");
        const int lock = ::open(lock_file.c_str(), O_RDWR | O_CLOEXEC);
        // Else somebody makes it anew.
        if (lock >= 0 && ::flock(lock, LOCK_EX | LOCK_NB) == 0) {
            for (const char* extension : {"notes", "cw2mesh", "d", "lock"})
                fs::remove(fs::path(entry.path).replace_extension(extension), error);
            bytes -= entry.bytes;
        }
        if (lock >= 0) ::close(lock);
    }
}

std::unique_ptr<SourceBake> bake_of(const Options& options, const Device& device,
                                    std::function<void(const std::string&)> tell) {
    if (!is_source(options.scene)) return nullptr;
    const BakeSettings settings{.z_up = options.z_up,
                                .strict = options.strict,
                                .restricted = options.restricted,
                                .uncompressed = texture_settings(options, device).decode_blocks};
    return std::make_unique<SourceBake>(options.scene, settings, std::move(tell));
}

void tell_user(const std::string& line) {
    // In the place of what wait_for() shows.
    fmt::print(stderr, "{}{}\n", ::isatty(STDERR_FILENO) != 0 ? "\r\033[K" : "", line);
}

void wait_for(SourceBake& bake) {
    const bool is_shown = ::isatty(STDERR_FILENO) != 0;
    while (!bake.done(std::chrono::milliseconds(100)))
        if (is_shown) fmt::print(stderr, "\r\033[K{}", bake.progress());
    if (is_shown) fmt::print(stderr, "\r\033[K");
}

}  // namespace cw2
