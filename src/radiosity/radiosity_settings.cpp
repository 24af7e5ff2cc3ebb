#include "radiosity/radiosity_settings.h"

namespace pertev {

const char* name_of(FormFactors method) {
    switch (method) {
    case FormFactors::Rays:
        return "rays";
    case FormFactors::Hemicube:
        return "hemicube";
    }
    return "";
}

const char* name_of(RadiositySolver solver) {
    switch (solver) {
    case RadiositySolver::Southwell:
        return "southwell";
    case RadiositySolver::GaussSeidel:
        return "gauss-seidel";
    case RadiositySolver::Matrix:
        return "matrix";
    case RadiositySolver::Hierarchical:
        return "hierarchical";
    }
    return "";
}

} // namespace pertev
