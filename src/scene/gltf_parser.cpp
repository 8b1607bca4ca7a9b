// The parser's own code, once in the program; gltf_document.h says how it is set up.
#include <fstream>  // which the parser uses, but does not include without its file functions

#define TINYGLTF_IMPLEMENTATION
#include "scene/gltf_document.h"
