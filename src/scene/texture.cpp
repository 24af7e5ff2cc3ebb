#include "scene/texture.h"

#include "math/portable_math.h"

namespace pertev {

void set_transform(TextureRef& texture, const TextureTransform& transform) {
    const float s = sin(transform.rotation), c = cos(transform.rotation);
    texture.m00 = c * transform.scale.x;
    texture.m01 = s * transform.scale.y;
    texture.m02 = transform.offset.x;
    texture.m10 = -s * transform.scale.x;
    texture.m11 = c * transform.scale.y;
    texture.m12 = transform.offset.y;
}

} // namespace pertev
