/* SPDX-License-Identifier: Apache-2.0 */
/*
 * corridor.cc - OMPL's RRT-Connect behind a function of C
 *
 * Axes are scaled to the mm that they move the electrode by, so that a distance
 * of two states means something.
 */
#include "corridor.h"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <new>

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace {

constexpr double NARROW_MM = 0.05;	/* the least spread of a sample */
constexpr double BLOCK_MM = 3;		/* the longest block that is tried */

const double *values(const ob::State *s)
{
	return s->as<ob::RealVectorStateSpace::StateType>()->values;
}

double *values(ob::State *s)
{
	return s->as<ob::RealVectorStateSpace::StateType>()->values;
}

void to_axes(const corridor &c, const ob::State *s, double q[INTERP_NAXES])
{
	std::memcpy(q, c.guess[0], sizeof(double) * INTERP_NAXES);
	for (uint32_t a = 0; a < c.naxes; a++)
		q[c.axis[a]] = values(s)[a] / c.reach_mm[c.axis[a]];
}

void to_state(const corridor &c, const double q[INTERP_NAXES], ob::State *s)
{
	for (uint32_t a = 0; a < c.naxes; a++)
		values(s)[a] = q[c.axis[a]] * c.reach_mm[c.axis[a]];
}

/* A pose of the guess, between two of its nodes, and so far from it as its own
 * draw says: near ones and far ones of all sizes. */
class around : public ob::RealVectorStateSampler {
public:
	around(const ob::StateSpace *space, const corridor &c)
		: ob::RealVectorStateSampler(space), c_(c)
	{
	}

	void sampleUniform(ob::State *s) override
	{
		const auto i = static_cast<uint32_t>(
			rng_.uniformInt(0, static_cast<int>(c_.nguess) - 2));
		const double t = rng_.uniform01();
		const double spread = NARROW_MM *
			std::pow(c_.wide_mm / NARROW_MM, rng_.uniform01());
		double q[INTERP_NAXES];

		for (int k = 0; k < INTERP_NAXES; k++)
			q[k] = c_.guess[i][k] + t * (c_.guess[i + 1][k] -
						     c_.guess[i][k]);
		to_state(c_, q, s);
		for (uint32_t a = 0; a < c_.naxes; a++)
			values(s)[a] += rng_.gaussian(0, spread);
		space_->enforceBounds(s);
	}

private:
	const corridor &c_;
};

class proof : public ob::MotionValidator {
public:
	proof(const ob::SpaceInformationPtr &si, const corridor &c)
		: ob::MotionValidator(si), c_(c)
	{
	}

	bool checkMotion(const ob::State *from,
			 const ob::State *to) const override
	{
		double a[INTERP_NAXES], b[INTERP_NAXES];

		to_axes(c_, from, a);
		to_axes(c_, to, b);
		return c_.keeps(c_.arg, a, b);
	}

	bool checkMotion(const ob::State *from, const ob::State *to,
			 std::pair<ob::State *, double> &last) const override
	{
		const bool ok = checkMotion(from, to);

		last.second = ok ? 1 : 0;
		if (last.first)
			si_->copyState(last.first, ok ? to : from);
		return ok;
	}

private:
	const corridor &c_;
};

/* Its spread is drawn from the same numbers in each run. */
void seed_once()
{
	static const bool done = (ompl::RNG::setSeed(1), true);

	(void)done;
}

ob::StateSpacePtr space_of(const corridor &c)
{
	auto space = std::make_shared<ob::RealVectorStateSpace>(c.naxes);
	ob::RealVectorBounds bounds(c.naxes);

	for (uint32_t a = 0; a < c.naxes; a++) {
		bounds.setLow(a, c.low[c.axis[a]] * c.reach_mm[c.axis[a]]);
		bounds.setHigh(a, c.high[c.axis[a]] * c.reach_mm[c.axis[a]]);
	}
	space->setBounds(bounds);
	space->setStateSamplerAllocator([&c](const ob::StateSpace *s) {
		return std::make_shared<around>(s, c);
	});
	return space;
}

bool solve(const corridor &c, og::SimpleSetup &setup)
{
	const auto planner = std::make_shared<og::RRTConnect>(
		setup.getSpaceInformation());
	uint32_t left = c.tries;

	planner->setRange(BLOCK_MM);
	setup.setPlanner(planner);
	setup.solve(ob::PlannerTerminationCondition([&c, &left] {
		return left == 0 || left-- == 0 || c.stop(c.arg);
	}));
	return setup.haveExactSolutionPath();
}

int find(const corridor &c, double (*ret)[INTERP_NAXES], uint32_t max)
{
	og::SimpleSetup setup(space_of(c));
	const auto si = setup.getSpaceInformation();
	ob::ScopedState<> from(si), to(si);

	si->setMotionValidator(std::make_shared<proof>(si, c));
	setup.setStateValidityChecker([&c](const ob::State *s) {
		double q[INTERP_NAXES];

		to_axes(c, s, q);
		return c.keeps(c.arg, q, q);
	});
	to_state(c, c.guess[0], from.get());
	to_state(c, c.guess[c.nguess - 1], to.get());
	setup.setStartAndGoalStates(from, to);
	if (!solve(c, setup))
		return 0;

	auto &path = setup.getSolutionPath();
	og::PathSimplifier simpler(si);

	simpler.reduceVertices(path);
	if (path.getStateCount() > max)
		return 0;
	for (size_t i = 0; i < path.getStateCount(); i++)
		to_axes(c, path.getState(i), ret[i]);
	/* As they were given: scaling to mm and back is off by a rounding. */
	std::memcpy(ret[0], c.guess[0], sizeof(*ret));
	std::memcpy(ret[path.getStateCount() - 1], c.guess[c.nguess - 1],
		    sizeof(*ret));
	return static_cast<int>(path.getStateCount());
}

} // namespace

int corridor_find(const struct corridor *c, double (*ret)[INTERP_NAXES],
		  uint32_t max)
{
	try {
		ompl::msg::noOutputHandler();
		seed_once();
		return find(*c, ret, max);
	} catch (const std::bad_alloc &) {
		return -ENOMEM;
	} catch (const std::exception &) {
		return 0;
	}
}
