#pragma once

// The flags of a verb that makes pictures: options made from the table of settings, files, and reports.

#include <string>
#include <vector>

#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "apps/cli/setting_flags.h"

namespace pertev {

struct RenderFlags : PictureOptions {
    std::vector<std::string> outputs;
    SettingFlags settings;
    ReportFlags report;
};

} // namespace pertev
