#include "io/finite_values.h"

#include <string>

#include "phyxel/error.h"

namespace phyxel {

void refuse_value(const std::filesystem::path& path, std::string_view what, std::size_t index) {
    throw Error("refused to write " + path.string() + ": number " + std::to_string(index) + " of its " +
                std::string(what) + " is not finite; the simulation has failed, look at what it reports");
}

}  // namespace phyxel
