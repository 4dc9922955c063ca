/* SPDX-License-Identifier: MIT */
/* The rules that choose which wire serves a device, and which way of a wire is open. */
#include "src/daemon/engine/routing/route.h"

/* --- A comma --------------------------------------------------------------------------------- */

/* The first other group on which the device may be; one where it fails only for want of another. */
static int elsewhere(const struct known_presence *known, const struct route_group *groups,
                     unsigned count, unsigned current)
{
	int failing = -1;

	for (unsigned g = 0; g < count; g++) {
		if (g == current || groups[g].state != ROUTE_UP ||
		    known[g].presence == ROUTE_ABSENT)
			continue;
		if (known[g].presence != ROUTE_FAILING)
			return (int)g;
		if (failing < 0)
			failing = (int)g;
	}
	return failing;
}

/* The first other group that says to have it. */
static int claimed(const struct known_presence *known, const struct route_group *groups,
                   unsigned count, unsigned current)
{
	for (unsigned g = 0; g < count; g++)
		if (g != current && groups[g].state == ROUTE_UP &&
		    known[g].presence == ROUTE_PRESENT)
			return (int)g;
	return -1;
}

/* It may well be on the current group: only good evidence on an earlier one takes it back. */
static struct route_choice give_back(const struct known_presence *known,
                                     const struct route_group *groups, unsigned current,
                                     int64_t moved_ns, int64_t now_ns)
{
	struct route_choice choice = {current, INT64_MAX, NULL};

	for (unsigned g = 0; g < current; g++) {
		int64_t at;

		if (groups[g].state != ROUTE_UP || known[g].presence != ROUTE_PRESENT)
			continue;
		at = ROUTE_HOLD_NS +
		     later_ns(later_ns(known[g].since_ns, groups[g].since_ns), moved_ns);
		if (now_ns >= at)
			return (struct route_choice){g, INT64_MAX, "its device is there again"};
		choice.again_ns = earlier_ns(choice.again_ns, at);
	}
	return choice;
}

struct route_choice route_device(const struct known_presence *known,
                                 const struct route_group *groups, unsigned count, unsigned current,
                                 int64_t moved_ns, int64_t now_ns)
{
	enum route_presence here = known[current].presence;
	bool down = groups[current].state == ROUTE_DOWN;
	int other = elsewhere(known, groups, count, current);

	if (here == ROUTE_ABSENT && other >= 0)
		return (struct route_choice){(unsigned)other, INT64_MAX,
		                             "its device is absent there"};
	if (here == ROUTE_FAILING && claimed(known, groups, count, current) >= 0)
		return (struct route_choice){(unsigned)claimed(known, groups, count, current),
		                             INT64_MAX, "its device gives no good value there"};
	if ((here == ROUTE_UNKNOWN || here == ROUTE_FAILING) && down && other >= 0)
		return (struct route_choice){(unsigned)other, INT64_MAX, "the target is down"};
	if (here != ROUTE_ABSENT)
		return give_back(known, groups, current, moved_ns, now_ns);
	/* absent everywhere: the first one's */
	for (unsigned g = 0; g < current; g++)
		if (groups[g].state == ROUTE_UP)
			return (struct route_choice){g, INT64_MAX,
			                             "its device is absent everywhere"};
	return (struct route_choice){current, INT64_MAX, NULL};
}

struct route_choice route_path(const struct route_group *groups, unsigned count, unsigned current,
                               int64_t now_ns)
{
	struct route_choice choice = {current, INT64_MAX, NULL};

	for (unsigned g = 0; g < count; g++) {
		int64_t at = groups[g].since_ns + ROUTE_HOLD_NS;

		if (g == current || groups[g].state != ROUTE_UP)
			continue;
		if (groups[current].state == ROUTE_DOWN)
			return (struct route_choice){g, INT64_MAX, "the target is down"};
		if (g > current)
			continue;
		if (now_ns >= at)
			return (struct route_choice){g, INT64_MAX, "the target is up again"};
		choice.again_ns = earlier_ns(choice.again_ns, at);
	}
	return choice;
}

int route_probe(const struct known_presence *known, const struct route_group *groups,
                unsigned count, unsigned current, unsigned last)
{
	bool lost = known[current].presence == ROUTE_ABSENT ||
	            known[current].presence == ROUTE_FAILING ||
	            (known[current].presence == ROUTE_UNKNOWN &&
	             groups[current].state == ROUTE_DOWN);

	for (unsigned i = 1; i <= count; i++) {
		unsigned g = (last + i) % count;

		if (g == current || groups[g].state != ROUTE_UP)
			continue;
		if (lost || (g < current && known[g].presence == ROUTE_UNKNOWN))
			return (int)g;
	}
	return -1;
}

/* --- A bar ----------------------------------------------------------------------------------- */

void route_bar_init(struct route_bar *bar, unsigned count, int64_t patience_ns, int64_t now_ns)
{
	*bar = (struct route_bar){.count = count,
	                          .from = -1,
	                          .since_ns = now_ns,
	                          .patience_ns = patience_ns,
	                          .hold_ns = ROUTE_HOLD_NS};
}

/* When the open way failed; INT64_MAX: it has not. */
static int64_t failed_at(const struct route_bar *bar, const struct route_way *ways, int64_t now_ns)
{
	const struct route_way *way = &ways[bar->open];

	if (way->failed)
		return way->failed_ns;
	if (!way->up && now_ns >= bar->since_ns + bar->patience_ns)
		return bar->since_ns + bar->patience_ns;
	return INT64_MAX;
}

static bool steady(const struct route_way *way, int64_t until_ns)
{
	return way->up_ns && until_ns - way->up_ns >= ROUTE_STEADY_NS;
}

/* The way that is next in turn when the open one has failed; -1: none can be. */
static int successor(const struct route_bar *bar, const struct route_way *ways)
{
	for (unsigned i = 1; i < bar->count; i++) {
		unsigned w = (bar->open + i) % bar->count;

		if (ways[w].released)
			return (int)w;
	}
	return -1;
}

/*
 * How long a way that has failed is given before the next one's turn: nothing in the first round.
 */
static int64_t dwell(const struct route_bar *bar, const struct route_way *ways)
{
	unsigned rounds = (bar->failures + 1) / bar->count;
	int64_t ns = rounds > 5 ? ROUTE_DWELL_MAX_NS : ROUTE_DWELL_NS << rounds >> 1;

	if (!rounds)
		return 0;
	for (unsigned w = 0; w < bar->count; w++)
		if (ways[w].back && ns > ROUTE_HOLD_NS)
			return ROUTE_HOLD_NS;
	return ns;
}

static struct route_step move_on(const struct route_bar *bar, const struct route_way *ways,
                                 int64_t failed_ns, int64_t now_ns)
{
	struct route_step step = {ROUTE_STAY, bar->open, INT64_MAX, NULL};
	bool was_steady = steady(&ways[bar->open], failed_ns);
	int64_t at = failed_ns;
	int next;

	if (bar->from >= 0 && !was_steady && ways[bar->from].released) {
		next = bar->from;
	} else {
		next = successor(bar, ways);
		if (next < 0)
			return step;
		at += was_steady ? 0 : dwell(bar, ways);
	}
	if (now_ns < at) {
		step.again_ns = at;
		return step;
	}
	return (struct route_step){ROUTE_LEAVE, (unsigned)next, INT64_MAX,
	                           ways[bar->open].failed ? "the target is down"
	                                                  : "the target says nothing"};
}

static struct route_step go_back(const struct route_bar *bar, const struct route_way *ways,
                                 int64_t now_ns)
{
	struct route_step step = {ROUTE_STAY, bar->open, INT64_MAX, NULL};

	for (unsigned w = 0; w < bar->open; w++) {
		int64_t at;

		if (!ways[w].released || !ways[w].back)
			continue;
		at = later_ns(ways[w].back_ns, bar->since_ns) + bar->hold_ns;
		if (now_ns >= at)
			return (struct route_step){ROUTE_LEAVE, w, INT64_MAX,
			                           "the target is there again"};
		step.again_ns = earlier_ns(step.again_ns, at);
	}
	return step;
}

struct route_step route_bar(const struct route_bar *bar, const struct route_way *ways,
                            int64_t now_ns)
{
	struct route_step step = {ROUTE_STAY, bar->open, INT64_MAX, NULL};
	int64_t failed_ns;

	if (bar->letting_go) {
		if (ways[bar->leaving].released || now_ns >= bar->since_ns + ROUTE_RELEASE_NS)
			step.act = ROUTE_OPEN;
		else
			step.again_ns = bar->since_ns + ROUTE_RELEASE_NS;
		return step;
	}
	failed_ns = failed_at(bar, ways, now_ns);
	if (failed_ns != INT64_MAX)
		return move_on(bar, ways, failed_ns, now_ns);
	if (ways[bar->open].up)
		return go_back(bar, ways, now_ns);
	step.again_ns = bar->since_ns + bar->patience_ns;
	return step;
}

void route_bar_took(struct route_bar *bar, const struct route_way *ways,
                    const struct route_step *step, int64_t now_ns)
{
	int64_t failed_ns = failed_at(bar, ways, now_ns);

	if (step->act == ROUTE_STAY)
		return;
	bar->since_ns = now_ns;
	if (step->act == ROUTE_OPEN) {
		bar->letting_go = false;
		return;
	}
	if (failed_ns == INT64_MAX) { /* a return from a way that works */
		bar->from = (int)bar->open;
		bar->failures = 0;
	} else if (steady(&ways[bar->open], failed_ns)) {
		bar->from = -1;
		bar->failures = 1;
		bar->hold_ns = ROUTE_HOLD_NS;
	} else {
		if (bar->from >= 0 && bar->hold_ns < ROUTE_HOLD_MAX_NS)
			bar->hold_ns *= 2;
		bar->from = -1;
		bar->failures++;
	}
	bar->leaving = bar->open;
	bar->open = step->way;
	bar->letting_go = true;
}

enum route_state route_bar_state(const struct route_bar *bar, const struct route_way *ways,
                                 int64_t now_ns)
{
	if (bar->letting_go)
		return ROUTE_OPENING;
	if (failed_at(bar, ways, now_ns) != INT64_MAX)
		return ROUTE_DOWN;
	return ways[bar->open].up ? ROUTE_UP : ROUTE_OPENING;
}
