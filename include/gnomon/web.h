#pragma once

#include <gnomon/bake.h>

#include <filesystem>
#include <string>

/// A bake as a page in the browser. docs/bakes.md tells of the files.
namespace gnomon {

/// Writes DIR/index.html and what belongs to it: the model, lit by the bake at any time of its path
/// in the browser's own shaders. To be opened from a web server; the page asks no other for
/// anything. The folder appears whole or not at all, and replaces an older page there. `title`
/// stands above place and date; empty: "Sun and shadow".
/// Throws Error{input} when the folder holds anything else, Error{machine} when it cannot be made
/// or Gnomon was built without the page.
void write_web(const std::filesystem::path& folder, const IntervalBake& bake,
               const std::string& title = {});

/// To be asked before the work: whether write_web() can put its folder there. Throws as it does.
void check_web_folder(const std::filesystem::path& folder);

}  // namespace gnomon
