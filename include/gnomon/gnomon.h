#pragma once

/// All of gnomon but <gnomon/vulkan.h>.

#include <gnomon/bake.h>
#include <gnomon/context.h>
#include <gnomon/error.h>
#include <gnomon/image.h>
#include <gnomon/light.h>
#include <gnomon/light_path.h>
#include <gnomon/lighting.h>
#include <gnomon/math.h>
#include <gnomon/metrics.h>
#include <gnomon/progress.h>
#include <gnomon/report.h>
#include <gnomon/scene.h>
#include <gnomon/sun.h>
#include <gnomon/sun_hours.h>
#include <gnomon/technique.h>
#include <gnomon/vertex_lighting.h>
#include <gnomon/visibility.h>
#include <gnomon/web.h>
