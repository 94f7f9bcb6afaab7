#include "contact/contact.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace phyxel {
namespace {

bool stick_comes_before(const ContactSamples::Stick& a, const ContactSamples::Stick& b) {
    return std::tie(a.sample, a.collider) < std::tie(b.sample, b.collider);
}

}  // namespace

void ContactSamples::add_action(std::span<const Touch> touches, std::span<const Vec3> d, std::span<Vec3> out) const {
    for (const Touch& touch : touches) {
        const double push = stiffness(touch.sample) * dot(touch.normal, samples_.position(touch.sample, d));
        spread(touch.sample, push * touch.normal, out);
    }
}

std::vector<ContactSamples::Rub> ContactSamples::rubs(std::span<const Collider> colliders,
                                                      std::span<const Touch> touches, std::span<const Stick> sticks,
                                                      std::span<const Vec3> start) const {
    std::vector<Rub> list;
    for (const Touch& touch : touches) {
        const double limit = colliders[touch.collider].friction() * touch.push;
        if (!(limit > 0)) continue;
        Stick stick{touch.sample, touch.collider, {}};
        const auto old = std::lower_bound(sticks.begin(), sticks.end(), stick, stick_comes_before);
        const bool known = old != sticks.end() && !stick_comes_before(stick, *old);
        stick.anchor = known ? old->anchor : samples_.position(touch.sample, start);
        list.push_back({stick, {touch.normal, limit, stiffness(touch.sample)}});
    }
    return list;
}

void ContactSamples::add_friction_forces(std::span<const Rub> rubs, std::span<const Vec3> x, std::span<Vec3> f) const {
    for (const Rub& rub : rubs) spread(rub.stick.sample, rub.spring.force(slip(rub, x)), f);
}

void ContactSamples::add_friction_action(std::span<const Rub> rubs, std::span<const Vec3> x, std::span<const Vec3> d,
                                         std::span<Vec3> out) const {
    for (const Rub& rub : rubs) {
        const Vec3 change = rub.spring.slip(samples_.position(rub.stick.sample, d));
        spread(rub.stick.sample, rub.spring.action(slip(rub, x), change), out);
    }
}

std::vector<ContactSamples::Stick> ContactSamples::sticks(std::span<const Rub> rubs, std::span<const Vec3> x) const {
    std::vector<Stick> list;
    for (const Rub& rub : rubs) {
        Stick stick = rub.stick;
        stick.anchor = samples_.position(stick.sample, x) - rub.spring.kept(slip(rub, x));
        list.push_back(stick);
    }
    std::sort(list.begin(), list.end(), stick_comes_before);
    return list;
}

void ContactSamples::add_lumped(std::span<const Touch> touches, std::span<const Rub> rubs, std::span<const Vec3> x,
                                std::span<Mat3> blocks) const {
    const auto add = [&](std::uint32_t sample, const Mat3& K) {
        const double sum = samples_.absolute_sum(sample);
        for (std::uint32_t k = samples_.offset[sample]; k < samples_.offset[sample + 1]; ++k)
            blocks[samples_.node[k]] += sum * std::abs(samples_.phi[k]) * K;
    };
    for (const Touch& touch : touches) add(touch.sample, stiffness(touch.sample) * outer(touch.normal, touch.normal));
    for (const Rub& rub : rubs) add(rub.stick.sample, rub.spring.held_stiffness(slip(rub, x)));
}

}  // namespace phyxel
