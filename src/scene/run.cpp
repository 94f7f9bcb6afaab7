#include "scene/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "base/atomic_file.h"
#include "base/threads.h"
#include "io/surface_file.h"
#include "phyxel/error.h"
#include "scene/frame_files.h"
#include "scene/summary.h"
#include "scene/timeline.h"

namespace phyxel {
namespace {

/// Longest time [s] between two looks at the progress and at an interrupt. Implicit steps are as long as they are.
double piece_length(const SceneSimulation& simulation, const World& world) {
    constexpr double steps = 100, longest = 1.0 / 60;
    if (!is_explicit(simulation.integrator)) return std::numeric_limits<double>::infinity();
    return std::min(longest, steps * world.stable_substep());
}

class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

const char* word(RunStatus status) {
    return status == RunStatus::completed ? "completed" : status == RunStatus::interrupted ? "interrupted" : "failed";
}

/// One run of a scene, from its world to its summary.
class Run {
public:
    Run(const Scene& scene, const RunOptions& options)
        : scene_(scene),
          options_(options),
          folder_(options.folder.empty() ? std::filesystem::path("output") / scene.name : options.folder),
          built_(build_world(scene, options.threads)),
          timeline_(scene.simulation, piece_length(scene.simulation, built_.world)) {}

    RunResult run() {
        open();
        try {
            step_to_end();
            files_->finish();
        } catch (const Error& error) {
            end(RunStatus::failed, error.what());
        }
        close();
        return {status_, record_.message, folder_, built_.world.time(), record_.steps, record_.wall_seconds};
    }

private:
    /// Opens the output; nothing is created on disk before.
    void open();
    void load_checkpoint();
    void step_to_end();
    void write_frame(std::size_t frame);
    void save_checkpoint();
    void report_progress() const;
    void close();
    void write_fragments() const;

    bool is_checkpoint_due(std::size_t frame) const;
    void end(RunStatus status, const std::string& message) { status_ = status, record_.message = message; }

    const Scene& scene_;
    const RunOptions& options_;
    std::filesystem::path folder_;
    Stopwatch setup_;
    BuiltScene built_;
    Timeline timeline_;
    std::unique_ptr<FrameFiles> files_;
    Stopwatch stepping_;
    RunStatus status_ = RunStatus::completed;
    RunRecord record_;
    double start_ = 0;            // [s] simulated time at which this run began
    double last_checkpoint_ = 0;  // [s] simulated
    std::size_t next_frame_ = 0;
};

void Run::open() {
    // The painter sees the world at rest first, for its camera and for displacements
    const SceneOutput& output = scene_.output;
    std::unique_ptr<ScenePainting> painting;
    if (output.writes(OutputFormat::png) || output.writes(OutputFormat::mp4))
        painting = std::make_unique<ScenePainting>(scene_, built_);
    if (!options_.resume.empty()) load_checkpoint();

    create_folder(folder_);
    if (!options_.fragments.empty()) create_folder(options_.fragments);
    std::error_code ignored;
    std::filesystem::remove(folder_ / "summary.json", ignored);
    files_ = std::make_unique<FrameFiles>(scene_, built_, folder_, next_frame_, std::move(painting));

    last_checkpoint_ = start_;
    record_.resumed_from = start_;
    record_.threads = Threads(options_.threads).count();
    record_.smallest_step = std::numeric_limits<double>::infinity();
    record_.setup_seconds = setup_.seconds();
    stepping_ = Stopwatch();
}

void Run::load_checkpoint() {
    built_.world.load_checkpoint(options_.resume);
    start_ = built_.world.time();
    if (start_ >= scene_.simulation.duration * (1 - 1e-12))
        throw Error(
            fmt::format("{}: the checkpoint is at {:g} s, but the run ends at {:g} s; raise it with --set "
                        "simulation.duration=SECONDS",
                        options_.resume.string(), start_, scene_.simulation.duration));
    next_frame_ = timeline_.frame_at(start_) + 1;
}

void Run::step_to_end() {
    if (next_frame_ == 0) write_frame(0);
    while (next_frame_ <= timeline_.last_frame()) {
        if (options_.interrupted && options_.interrupted()) {
            end(RunStatus::interrupted, fmt::format("stopped by the user at {:g} s", built_.world.time()));
            save_checkpoint();
            return;
        }
        const Timeline::Stop stop = timeline_.next(built_.world.time());
        const StepReport step = built_.world.advance(stop.time - built_.world.time());
        record_.steps += step.substeps;
        record_.retries += step.retries;
        record_.newton_iterations += step.newton_iterations;
        record_.newton_worst = std::max(record_.newton_worst, step.newton_worst);
        record_.linear_iterations += step.linear_iterations;
        record_.linear_worst = std::max(record_.linear_worst, step.linear_worst);
        if (step.substeps > 0) record_.smallest_step = std::min(record_.smallest_step, step.substep);
        if (step.status == StepStatus::failed) {
            end(RunStatus::failed, step.message);
            write_frame(next_frame_);
            return;
        }
        if (stop.frame) write_frame(*stop.frame);
        report_progress();
    }
}

void Run::write_frame(std::size_t frame) {
    files_->write(frame);
    ++record_.frames;
    next_frame_ = frame + 1;
    if (is_checkpoint_due(frame)) save_checkpoint();
}

bool Run::is_checkpoint_due(std::size_t frame) const {
    if (frame == 0 || status_ == RunStatus::failed) return false;
    const std::optional<double>& every = scene_.output.checkpoint_every;
    if (!every) return !scene_.output.formats.empty();
    return built_.world.time() - last_checkpoint_ >= *every * (1 - 1e-9);
}

void Run::save_checkpoint() {
    built_.world.save_checkpoint(folder_ / "checkpoint.phyxel");
    last_checkpoint_ = built_.world.time();
}

void Run::report_progress() const {
    if (options_.progress)
        options_.progress(
            {built_.world.time(), start_, scene_.simulation.duration, record_.steps, stepping_.seconds()});
}

void Run::close() {
    record_.status = word(status_);
    record_.wall_seconds = stepping_.seconds();
    if (record_.steps == 0) record_.smallest_step = 0;
    try {
        if (!options_.fragments.empty()) write_fragments();
        write_file(folder_ / "summary.json", summary_json(scene_, built_, record_));
    } catch (const Error& error) {
        end(RunStatus::failed, record_.message.empty() ? error.what() : record_.message + "; " + error.what());
    }
}

void Run::write_fragments() const {
    const std::vector<std::string> labels = file_labels(scene_.bodies);
    for (std::size_t i = 0; i < built_.bodies.size(); ++i) {
        const Surface& surface = built_.world.surface(built_.bodies[i]);
        write_ply(options_.fragments / (labels[i] + ".0.ply"), {surface.positions(), surface.triangles()});
    }
}

}  // namespace

RunResult run_scene(const Scene& scene, const RunOptions& options) { return Run(scene, options).run(); }

}  // namespace phyxel
