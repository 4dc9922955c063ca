/* SPDX-License-Identifier: MIT */
/* The accesses that were met, and how each is weakened. */
#include <string.h>

#include "tests/model/search.h"

/* In the order in which they were met */
static struct site *sites, *last_site;

const struct site *site_meet(struct site *site, int kind, int order)
{
	if (!site->same) {
		for (struct site *s = sites; s && !site->same; s = s->next)
			if (s->line == site->line && s->kind == kind &&
			    strcmp(s->file, site->file) == 0)
				site->same = s;
		if (!site->same) {
			site->same = site;
			site->kind = kind;
			site->order = order;
			if (last_site)
				last_site->next = site;
			else
				sites = site;
			last_site = site;
		}
	}
	site->same->scenarios |= 1u << x.bit;
	return site->same;
}

struct site *explore_sites(void)
{
	return sites;
}

/* The order that is left, -1: nothing at all; -2: there is no such way. */
static int weakened(const struct site *site, unsigned way, const char **words)
{
	static const struct {
		bool fence;
		int order, left;
		const char *words;
	} ways[] = {
		{false, __ATOMIC_ACQUIRE, __ATOMIC_RELAXED, "acquire to relaxed"},
		{false, __ATOMIC_RELEASE, __ATOMIC_RELAXED, "release to relaxed"},
		{false, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE, "acq_rel without release"},
		{false, __ATOMIC_ACQ_REL, __ATOMIC_RELEASE, "acq_rel without acquire"},
		{false, __ATOMIC_SEQ_CST, __ATOMIC_ACQUIRE, "seq_cst without release"},
		{false, __ATOMIC_SEQ_CST, __ATOMIC_RELEASE, "seq_cst without acquire"},
		{true, __ATOMIC_ACQUIRE, -1, "acquire fence taken away"},
		{true, __ATOMIC_RELEASE, -1, "release fence taken away"},
		{true, __ATOMIC_SEQ_CST, __ATOMIC_ACQ_REL, "seq_cst fence to acq_rel"},
		{true, __ATOMIC_SEQ_CST, -1, "seq_cst fence taken away"},
	};

	for (unsigned i = 0; i < sizeof(ways) / sizeof(ways[0]); i++) {
		if (ways[i].order != site->order || ways[i].fence != (site->kind == FENCE) ||
		    (site->kind == LOAD && ways[i].left == __ATOMIC_ACQUIRE) ||
		    (site->kind == STORE && ways[i].left == __ATOMIC_RELEASE) || way-- != 0)
			continue;
		*words = ways[i].words;
		return ways[i].left;
	}
	return -2;
}

const char *explore_way(const struct site *site, unsigned way)
{
	const char *words = NULL;

	weakened(site, way, &words);
	return words;
}

int site_order(const struct site *site, int order)
{
	const char *words;

	return x.mutant && x.mutant->site == site ? weakened(site, x.mutant->way, &words) : order;
}
