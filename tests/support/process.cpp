#include "tests/support/process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace {

// A file takes any amount of text, a pipe only what someone reads meanwhile.
std::unique_ptr<FILE, int (*)(FILE*)> temporary_file() {
    std::unique_ptr<FILE, int (*)(FILE*)> file(std::tmpfile(), std::fclose);
    if (!file) throw std::runtime_error(std::string("no temporary file: ") + std::strerror(errno));
    return file;
}

std::string contents(FILE* file) {
    std::string text(static_cast<std::size_t>(std::fseek(file, 0, SEEK_END) ? 0 : std::ftell(file)),
                     '\0');
    std::rewind(file);
    text.resize(std::fread(text.data(), 1, text.size(), file));
    return text;
}

[[noreturn]] void become(const std::vector<std::string>& command, const Surroundings& surroundings,
                         FILE* out, FILE* err) {
    std::vector<char*> arguments;
    for (const std::string& argument : command) {
        arguments.push_back(const_cast<char*>(argument.c_str()));
    }
    arguments.push_back(nullptr);
    for (const std::string& variable : surroundings.environment) {
        putenv(const_cast<char*>(variable.c_str()));
    }
    const int nothing = open("/dev/null", O_RDONLY);
    if (dup2(nothing, 0) < 0 || dup2(fileno(out), 1) < 0 || dup2(fileno(err), 2) < 0 ||
        (!surroundings.folder.empty() && chdir(surroundings.folder.c_str()) != 0)) {
        _exit(127);
    }
    execv(arguments[0], arguments.data());
    _exit(127);
}

}  // namespace

Running::Running(const std::vector<std::string>& command, const Surroundings& surroundings)
    : program_(command.front()), out_(temporary_file()), err_(temporary_file()), process_(fork()) {
    if (process_ < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
    if (process_ == 0) become(command, surroundings, out_.get(), err_.get());
}

Running::~Running() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
}

Outcome Running::wait() {
    int status = 0;
    while (waitpid(process_, &status, 0) < 0) {
        if (errno != EINTR) throw std::runtime_error(std::string("waitpid: ") + strerror(errno));
    }
    process_ = 0;
    const int code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    if (code == 127) throw std::runtime_error(program_ + ": cannot be started");
    return {code, contents(out_.get()), contents(err_.get())};
}

Outcome run(const std::vector<std::string>& command, const Surroundings& surroundings) {
    return Running(command, surroundings).wait();
}
