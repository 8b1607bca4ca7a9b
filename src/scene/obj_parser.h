#pragma once

// Coordinates far from the origin need double.
#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>
