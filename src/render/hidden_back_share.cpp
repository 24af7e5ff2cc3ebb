#include "render/hidden_back_share.h"

#include "device/buffer.h"
#include "device/launch.h"
#include "render/count_hidden_backs.h"

namespace pertev {

double hidden_back_share(Queue& queue, const PictureView& picture) {
    if (picture.scene.any_hidden_back == 0) return 0;
    Buffer<uint32_t> count(queue, 1, "count of hidden backs");
    count.zero();
    launch(queue, "count_hidden_backs", CountHiddenBacks::kRays,
           CountHiddenBacks{picture.scene, picture.camera.view, static_cast<float>(picture.camera.width),
                            static_cast<float>(picture.camera.height), count.data()});
    return static_cast<double>(count.download()[0]) / CountHiddenBacks::kRays;
}

} // namespace pertev
