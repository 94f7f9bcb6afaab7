#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/glb.h"
#include "io/video.h"
#include "io/vtu.h"
#include "scene/probe_log.h"
#include "scene/scene_painting.h"

namespace phyxel {

/// Everything a run writes per frame, into `FOLDER/frames/`, and what is made of all frames, into `FOLDER`:
///
///     frames/BODY.nodes.NNNNNN.vtu, .points., .surface.   vtu, listed in nodes.pvd, points.pvd, surface.pvd
///     frames/BODY.NNNNNN.ply, .obj                        ply, obj
///     frames/picture.NNNNNN.png                           png
///     video.mp4, animation.glb                            mp4, glb
///     probes.csv                                          always; the times alone when there are no probes
///
/// A resumed run goes on with the numbers of its frames. Film and animation cannot be continued: those of a resumed run
/// are called video.from-NNNNNN.mp4 and animation.from-NNNNNN.glb and begin with its first frame.
class FrameFiles {
public:
    /// `first_frame` is the first that will be written, 0 unless resumed. `painting` draws the pictures; it is needed
    /// when the scene asks for some.
    FrameFiles(const Scene& scene, const BuiltScene& built, std::filesystem::path folder, std::size_t first_frame,
               std::unique_ptr<ScenePainting> painting);

    void write(std::size_t frame);

    /// Ends film, animation and lists.
    void finish();

private:
    void write_vtu(const std::string& number, std::size_t body);
    void write_surface(const std::string& number, std::size_t body);
    void write_pictures(const std::string& number);
    void write_lists() const;
    void list_earlier_frames(std::size_t first_frame);

    const Scene* scene_;
    const BuiltScene* built_;
    std::filesystem::path folder_;
    std::vector<std::string> labels_;  // [bodies] their names as parts of file names
    std::vector<PvdEntry> nodes_, points_, surfaces_;
    std::unique_ptr<ProbeLog> probes_;
    std::unique_ptr<ScenePainting> painting_;
    std::unique_ptr<Mp4Writer> video_;
    std::unique_ptr<GlbWriter> animation_;
    std::size_t written_ = 0;
};

/// Names as parts of file names: letters, digits, '-' and '_' stay, the rest becomes '_'; no two are the same.
std::vector<std::string> file_labels(const std::vector<SceneBody>& bodies);

}  // namespace phyxel
