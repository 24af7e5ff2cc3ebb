#pragma once

// Renders a still picture whose samples are kept in a checkpoint (session/film_file/checkpoint.h) as it goes on.

#include <string>

#include "session/film_file/checkpoint.h"
#include "session/session.h"
#include "session/writing/write_picture.h"
#include "settings/picture_options.h"

namespace pertev {

class RenderWithCheckpoint {
public:
    /// Makes the film of the session's picture and takes the samples of options.checkpoint, if it is there. `session`
    /// and `record`, which is that of the picture, outlive this. Throws as Checkpoint.
    RenderWithCheckpoint(Session& session, const PictureOptions& options, const PictureRecord& record, Sink& sink);

    /// Adds the samples that are missing, as render_samples. Writes the checkpoint every options.checkpoint_every_s
    /// seconds, where a failure is a warning, and in the end.
    RenderResult render(Sink& sink);
    Film& film() { return film_.film(); }
    FilmRender& film_render() { return film_; }
    /// Returns the checkpoint's file, with the reason if it could not be written in the end.
    const WrittenFile& written() const { return written_; }

private:
    void render_slice(double before_s, Sink& sink);
    Progress progress_of_all(Progress now, double before_s, uint64_t rays_before) const;
    bool write();

    const PictureRecord& record_;
    double every_s_;
    bool is_part_;
    RenderSettings settings_;
    FilmRender film_;
    Checkpoint checkpoint_;
    uint32_t known_ = 0;           // number of samples that the checkpoint had
    uint64_t known_rays_ = 0;      // rays of those
    std::optional<uint32_t> kept_; // number of samples that it has; none before it is written
    WrittenFile written_;
};

} // namespace pertev
