#pragma once

// castRay writes a line to stderr for every ray that leaves the key range. The time of that is not castRay's
// own, so its template is compiled without the messages wherever a benchmark includes OctoMap's trees.
#include <octomap/octomap_types.h>
#undef OCTOMAP_WARNING
#undef OCTOMAP_WARNING_STR
#undef OCTOMAP_ERROR
#undef OCTOMAP_ERROR_STR
#define OCTOMAP_WARNING(...) ((void)0)
#define OCTOMAP_WARNING_STR(args) ((void)0)
#define OCTOMAP_ERROR(...) ((void)0)
#define OCTOMAP_ERROR_STR(args) ((void)0)
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
