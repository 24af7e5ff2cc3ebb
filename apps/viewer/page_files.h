#pragma once

// The page's files, which embed_page.cmake embeds in the program.

#include <vector>

#include "apps/viewer/web_server.h"

namespace pertev {

std::vector<PageFile> page_files();

} // namespace pertev
