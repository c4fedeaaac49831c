// Numbers printed and parsed for a sanitizer to watch.
#pragma once

#include <cstddef>

namespace parallel {

// Exits with a message if what is parsed differs from what was printed, or threads change the text.
void check_text(std::size_t rows);

}  // namespace parallel
