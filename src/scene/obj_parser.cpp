// The parser's own code, once in the program.
#define TINYOBJLOADER_IMPLEMENTATION
#include "scene/obj_parser.h"
