#include "session/mpi/ranks.h"

#include <charconv>
#include <cstdlib>
#include <exception>
#include <initializer_list>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "device/backend.h"
#include "session/sample_range.h"
#include "settings/setting_table.h"

#if defined(PERTEV_MPI)
#define OMPI_SKIP_MPICXX 1
#include <mpi.h>
#endif

namespace pertev {
namespace {

/// Returns the number in the first of these variables that is set, or `otherwise`. Open MPI sets those that begin with
/// OMPI; MPICH and Slurm set the others.
uint32_t number_of_variable(std::initializer_list<const char*> variables, uint32_t otherwise) {
    for (const char* variable : variables) {
        const char* const text = std::getenv(variable);
        if (text == nullptr) continue;
        const std::string_view digits(text);
        std::from_chars(digits.data(), digits.data() + digits.size(), otherwise);
        break;
    }
    return otherwise;
}

/// Returns how many processes mpirun has started with this one; 1 without mpirun.
uint32_t processes_of_mpirun() { return number_of_variable({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}, 1); }

/// Returns the number of this process among those on its machine.
uint32_t number_on_machine() {
    return number_of_variable({"OMPI_COMM_WORLD_LOCAL_RANK", "MPI_LOCALRANKID", "SLURM_LOCALID"}, 0);
}

void set_option(PictureOptions& options, const char* name, const std::string& text) {
    set_value(options, *find_setting(name), std::span(&text, 1));
}

} // namespace

std::string gpu_of_rank(uint32_t number, uint32_t gpus) {
    return gpus > 1 ? fmt::format("cuda:{}", number % gpus) : "";
}

void Ranks::divide(const std::string& output, PictureOptions& options) const {
    if (options.is_given("checkpoint")) {
        throw Error(ErrorCode::BadInput, "checkpoint", options.checkpoint,
                    "each process of mpirun keeps its part in a file of its own beside the first output");
    }
    const auto gpus = static_cast<uint32_t>(cuda_device_count());
    const std::string gpu = gpu_of_rank(number_on_machine(), gpus);
    if (!options.is_given("device") && !gpu.empty()) options.machine.device = gpu;
    set_option(options, "part", fmt::format("{}/{}", rank_ + 1, count_));
    if (has_frames(options)) return; // each writes the files of its own
    set_option(options, "checkpoint", fmt::format("{}.part-{}-of-{}.pvf", output, rank_ + 1, count_));
}

#if defined(PERTEV_MPI)
namespace {

constexpr std::size_t kAtOnce = std::size_t(1) << 20; // elements of a message

/// Adds exact sums; the operation of MPI_Reduce.
void add_sums(void* from, void* to, int* count, MPI_Datatype*) {
    const auto* const a = static_cast<const FixedSum*>(from);
    auto* const b = static_cast<FixedSum*>(to);
    for (int i = 0; i < *count; ++i) b[i] = a[i] + b[i];
}

/// Type and operation of exact sums.
class SumOperation {
public:
    SumOperation() {
        static_assert(sizeof(FixedSum) == 16);
        MPI_Type_contiguous(16, MPI_BYTE, &type_);
        MPI_Type_commit(&type_);
        MPI_Op_create(&add_sums, 1, &operation_);
    }
    ~SumOperation() {
        MPI_Op_free(&operation_);
        MPI_Type_free(&type_);
    }
    SumOperation(const SumOperation&) = delete;
    SumOperation& operator=(const SumOperation&) = delete;

    /// Sums `sums` of all ranks into those of the first.
    void reduce(const std::vector<std::byte>& sums, std::vector<std::byte>& into) const {
        MPI_Reduce(sums.data(), into.data(), static_cast<int>(sums.size() / 16), type_, operation_, 0, MPI_COMM_WORLD);
    }

private:
    MPI_Datatype type_ = MPI_DATATYPE_NULL;
    MPI_Op operation_ = MPI_OP_NULL;
};

/// Adds a part of the same target of all other ranks to that of the first one.
void add_from_others(const Ranks& ranks, const SumOperation& sums, FilmTarget& target, std::size_t first,
                     std::size_t size) {
    std::vector<std::byte> bytes(size), others(size);
    const bool is_first = ranks.rank() == 0, is_of_sums = dynamic_cast<const SumTarget*>(&target) != nullptr;
    if (!is_first) target.read(first, bytes); // the first one contributes zeros to the sum of the others
    if (is_of_sums) {
        sums.reduce(bytes, others);
        if (is_first) target.add_bytes(first, others);
        return;
    }
    const auto length = static_cast<int>(size);
    if (!is_first) {
        MPI_Send(bytes.data(), length, MPI_BYTE, 0, 0, MPI_COMM_WORLD);
        return;
    }
    for (uint32_t rank = 1; rank < ranks.count(); ++rank) {
        MPI_Recv(others.data(), length, MPI_BYTE, static_cast<int>(rank), 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        target.add_bytes(first, others);
    }
}

} // namespace

std::unique_ptr<Ranks> Ranks::join() {
    if (processes_of_mpirun() < 2) return nullptr;
    int rank = 0, count = 1;
    MPI_Init(nullptr, nullptr);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &count);
    return std::unique_ptr<Ranks>(new Ranks(static_cast<uint32_t>(rank), static_cast<uint32_t>(count)));
}

Ranks::~Ranks() {
    if (std::uncaught_exceptions() == 0) MPI_Finalize();
}

bool Ranks::all(bool here) const {
    const int mine = here ? 1 : 0;
    int least = 0;
    MPI_Allreduce(&mine, &least, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    return least == 1;
}

void Ranks::sum_targets(Film& film) const {
    const SumOperation sums;
    for (const auto& target : film.targets()) {
        const std::size_t stride = target->stride(), most = std::max<std::size_t>(kAtOnce * 16 / stride, 1) * stride;
        for (std::size_t first = 0; first < target->byte_count(); first += most)
            add_from_others(*this, sums, *target, first, std::min(most, target->byte_count() - first));
    }
}

/// Sums films of which the first rank's denoiser has its own part, and lets it have all.
void Ranks::sum_denoised(uint32_t spp, FilmRender& film, const RayCounts& rays, double seconds) const {
    const RenderSettings& settings = film.settings();
    Queue queue = Queue::make_cpu();
    Film all = make_film(queue, settings);
    all.hold(std::make_unique<DenoiserTarget>(denoiser_state_size(settings.denoise, settings.width, settings.height)));
    for (std::size_t i = 0; i < all.targets().size(); ++i)
        all.targets()[i]->set_bytes(film.film().targets()[i]->bytes());
    sum_targets(all);
    if (rank_ > 0) return;
    const auto take = [&](Film& into) {
        for (std::size_t i = 0; i < all.targets().size(); ++i)
            into.targets()[i]->add_bytes(0, all.targets()[i]->bytes());
    };
    film.restore({0, spp}, take, rays, seconds);
}

void Ranks::sum(uint32_t spp, FilmRender& film, RenderResult& result) const {
    const uint64_t rays[] = {result.rays.camera, result.rays.bounce, result.rays.shadow};
    uint64_t all_rays[3] = {};
    double seconds = 0;
    MPI_Reduce(rays, all_rays, 3, MPI_UINT64_T, MPI_SUM, 0, MPI_COMM_WORLD);
    MPI_Reduce(&result.render_seconds, &seconds, 1, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
    const RayCounts sum_of_rays = {all_rays[0], all_rays[1], all_rays[2]};
    const bool is_denoised = film.settings().is_denoised();
    if (is_denoised) {
        sum_denoised(spp, film, sum_of_rays, seconds);
    } else {
        sum_targets(film.film());
    }
    if (rank_ > 0) return;
    film.film().set_samples({0, spp});
    const bool is_transparent = result.picture.channels == 4;
    result.samples = spp;
    result.rays = sum_of_rays;
    result.render_seconds = seconds;
    result.invalid_samples = film.film().invalid_samples();
    result.picture = film.film().picture(is_transparent);
    result.layers = film.layers();
    result.ids = film.film().ids();
    if (is_denoised) result.denoised = film.denoised(), result.denoiser = film.denoiser();
}

#else

std::unique_ptr<Ranks> Ranks::join() {
    const uint32_t count = processes_of_mpirun();
    if (count < 2) return nullptr;
    throw Error(ErrorCode::BadInput,
                fmt::format("mpirun has started {} processes, and this program was built without MPI "
                            "(PERTEV_MPI); each would render the whole picture",
                            count));
}

Ranks::~Ranks() { static_cast<void>(rank_); }
bool Ranks::all(bool here) const { return here; }
void Ranks::sum(uint32_t, FilmRender&, RenderResult&) const {}

#endif

} // namespace pertev
