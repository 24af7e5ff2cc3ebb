#pragma once

// Several tracers on the same rays, on one thread, in turns: rays come in chunks, and in each of several rounds every
// contestant traces each chunk, one after the other. What else runs on the machine then takes from all of them.

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "bench/embree_peer.h"
#include "trace/scene_trees.h"

namespace pertev::bench {

/// One who traces a chunk of rays: what comes back is the seconds of this thread that it took, and how many rays met
/// something.
struct Contestant {
    std::string name;
    std::function<double(std::span<const Ray>, std::size_t& hits)> trace;
};

struct EmbreePeers {
    const EmbreePeer& robust;
    const EmbreePeer& fast;
};

/// How pictures on a CPU trace many rays: camera and shadow rays that are coherent in packets; bounces in flight.
enum class OurWay { Single, Scattered, Together };
const char* name_of(OurWay way);

/// Ours in all ways, and Embree's in all ways, "robust" and "fast" with the way's name.
std::vector<Contestant> make_contestants(const HostTrees& trees, const EmbreePeers& peers, bool any_hit, bool coherent);
std::string embree_name(const std::string& mode, EmbreeWay way);

class Contest {
public:
    Contest(const std::vector<Contestant>& contestants, const std::vector<Ray>& rays, int rounds);

    /// How many times as fast as `theirs` `ours` is: median over all pairs of runs.
    double ratio(const std::string& ours, const std::string& theirs) const;
    double mrays_per_s(const std::string& name) const;
    std::size_t hits(const std::string& name) const { return hits_.at(name); }
    /// Where Embree takes many rays at once in this mode: the way that it is fastest.
    std::string strongest(const std::string& mode) const;

private:
    std::map<std::string, std::vector<double>> seconds_; // [contestant][round and chunk]
    std::map<std::string, std::size_t> hits_;            // hits of one round
    std::size_t traced_;                                 // rays, all rounds together
};

} // namespace pertev::bench
