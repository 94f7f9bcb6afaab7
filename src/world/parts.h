#pragma once

#include <map>

#include "solver/step.h"

namespace phyxel {

/// What a world is made of; behind `World` so that its header stays plain.
struct World::Parts {
    struct Slot {
        std::uint32_t generation = 0;
        std::size_t body = 0;  ///< index into `bodies`
        bool alive = false;
    };
    struct BodyInfo {
        BodyId id;
        MeshReport mesh_report;
        double energy_at_start = 0;   ///< [J] gravitational included
        double gravity_at_start = 0;  ///< [J]
    };
    struct FixName {
        BodyId body;
        std::size_t number;  ///< in the body's constraints
    };
    struct Probe {
        BodyId body;
        Vec3 rest;
        EmbeddedPoints point;
    };

    WorldSettings settings;
    Threads threads{1};
    Surroundings around;
    double time = 0;
    std::vector<Slot> slots;
    std::vector<std::unique_ptr<DynamicBody>> bodies;
    std::vector<BodyInfo> infos;  ///< of `bodies`
    std::vector<FixName> fixes;
    std::vector<Probe> probes;
    std::map<std::string, std::size_t> warnings;
    double measured_seconds = 0;  ///< [s] that the last step advanced
    double largest_energy = 0;    ///< [J] seen so far

    std::size_t index_of(BodyId id) const;
    DynamicBody& body(BodyId id) { return *bodies[index_of(id)]; }
    const DynamicBody& body(BodyId id) const { return *bodies[index_of(id)]; }
    void warn(const std::string& message, std::size_t count = 1) { warnings[message] += count; }

    /// Remembers the largest energy that is cheaply known: of motion, of heights, and what came and went.
    void note_energy();
    /// Energies of all bodies. Remembers the largest of them, which `balance_error` is relative to.
    EnergyLedger ledger();
};

}  // namespace phyxel
