#pragma once

// Pictures as arrays: files, comparison and tone mapping, with the bytes of the program.

#include <nanobind/nanobind.h>

namespace pertev {

void define_images(nanobind::module_& module);

} // namespace pertev
