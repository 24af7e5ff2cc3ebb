#include "formats/read_scene.h"
