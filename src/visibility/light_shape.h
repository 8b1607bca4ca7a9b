#pragma once

#include <gnomon/light.h>
#include <gnomon/math.h>

#include "raster/receivers.h"
#include "visibility/light_shape.shared.h"

namespace gnomon {

/// The light as shaders see it.
shared::LightShape light_shape(const Light& light);

/// Where a light within the world is, or its middle.
DVec3 center_ws(const Light& light);

/// True where two lights are at one place and of one size, whatever their colours, strengths and
/// cones: what is traced for one serves the other.
bool same_place(const Light& a, const Light& b);

/// For visibility/receiver.glsl.
shared::ReceiverPush receiver_push(const raster::Receivers& receivers, const Light& light);

}  // namespace gnomon
