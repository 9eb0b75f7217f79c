// What an image's texels mean to a material, as floats.
#pragma once

#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/textures/image.h"
#include "cw2-bake/textures/mip_chain.h"

namespace bake {

// The sources refer to the image, which must outlive them; one thread at a time may use one.

/// One channel, in [0, 1]. Channel::standard is red. A grey image has its grey in red, green and
/// blue; an image without alpha is opaque. Luminance is that of Rec. 709, of the stored values.
TexelSource scalar_texels(const Image& image, Channel channel);

/// Linear red, green and blue, in [0, 1]. Images of 8 or 16 bits hold sRGB, others linear light.
TexelSource color_texels(const Image& image);

/// As filter_masked_color() wants them: a texel of `image` is shown where a texel of `mask` that it
/// covers reaches `cutoff`. The two may differ in size; `mask` has one channel.
TexelSource masked_color_texels(const Image& image, const TexelSource& mask, float cutoff);

/// Red, green and blue as they are stored, in [0, 1] unless floats are outside it. Of an image of
/// two channels without alpha these are red and green; blue is 0.
TexelSource stored_texels(const Image& image);

/// Unit vectors in tangent space, x right, y up, z at least 0: those that an RGB image encodes as
/// 0.5 n + 0.5, with |z| for z. With `xy_only` z is not read, but sqrt(1 - x^2 - y^2).
TexelSource normal_texels(const Image& image, bool xy_only = false);

/// As normal_texels(), from a height map by central differences; heights are those of the channel
/// (from an image of floats as they are, not only in [0, 1]) times `scale` in texels.
TexelSource normal_texels_of_heights(const Image& image, Channel channel, float scale, bool clamp);

/// Whether the image has one colour channel, or three that are equal but for a JPEG's noise.
bool is_grey(const Image& image);

struct Range {
    float smallest;
    float largest;
};

/// Of the texels of a source of one channel.
Range range_of(const TexelSource& source);

}  // namespace bake
