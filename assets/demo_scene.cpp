#include "assets/demo_scene.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

#include "assets/mesh_writer.h"
#include "assets/scene.h"
#include "assets/textures.h"

namespace assets {
namespace {

/// Runs every job once, on as many threads as there are cores; throws the first job's error.
void run_all(const std::vector<std::function<void()>>& jobs) {
    std::atomic<std::size_t> next = 0;
    std::vector<std::exception_ptr> errors(jobs.size());
    const auto work = [&] {
        for (std::size_t i = next++; i < jobs.size(); i = next++) {
            try {
                jobs[i]();
            } catch (...) {
                errors[i] = std::current_exception();
            }
        }
    };
    {
        std::vector<std::jthread> threads;
        const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
        for (unsigned i = 0; i < cores; ++i) threads.emplace_back(work);
    }
    for (const std::exception_ptr& error : errors) {
        if (error) std::rethrow_exception(error);
    }
}

}  // namespace

void write_demo_scene(const std::filesystem::path& directory) {
    const std::filesystem::path textures = directory / "textures";
    std::filesystem::create_directories(textures);
    std::vector<std::function<void()>> jobs;
    jobs.emplace_back([&] {
        write_mtl(directory / "courtyard.mtl", materials());
        write_obj(directory / "courtyard.obj", "courtyard.mtl", courtyard());
    });
    for (const TextureSet& set : texture_sets()) {
        jobs.emplace_back([textures, set] { write_texture_set(textures, set); });
    }
    run_all(jobs);
}

}  // namespace assets
