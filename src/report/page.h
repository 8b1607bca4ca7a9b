#pragma once

#include "report/layout.h"

#include <string>

namespace gnomon::report {

/// index.html: page.html filled with the report's numbers, page.css and page.js within it.
/// All that comes from the report is escaped.
std::string page(const ComparisonReport& report, const Layout& layout);

}  // namespace gnomon::report
