/* SPDX-License-Identifier: MIT */
/*
 * The checker checked: small programs of which it is known, and published, what RC11 allows and
 * what it forbids. x, y, z are 0 before; each thread notes what it read.
 */
#include <stdio.h>
#include <string.h>

#include "tests/model/suites.h"

#define RLX __ATOMIC_RELAXED
#define ACQ __ATOMIC_ACQUIRE
#define REL __ATOMIC_RELEASE
#define SC __ATOMIC_SEQ_CST

static uint32_t x, y, z;
static struct notes {
	uint32_t a, b, c, d;
} r;
static bool happened;

#define W(where, value, order) __atomic_store_n(&(where), value, order)
#define R(where, order) __atomic_load_n(&(where), order)
#define F(order) __atomic_thread_fence(order)
#define INC(where, order) __atomic_fetch_add(&(where), 1, order)
#define THREAD(name, ...) \
	static void name(void) \
	{ \
		__VA_ARGS__; \
	}
#define OUTCOME(name, ...) \
	static void name(void) \
	{ \
		happened |= (__VA_ARGS__); \
	}

static void setup(void)
{
	x = y = z = 0;
	memset(&r, 0, sizeof(r));
	explore_track("x", &x, 4);
	explore_track("y", &y, 4);
	explore_track("z", &z, 4);
	explore_keep(&r, sizeof(r));
}

/* Store buffering: both threads read the other's old value */
OUTCOME(both_old, r.a == 0 && r.b == 0)
THREAD(sb1, W(x, 1, RLX); r.a = R(y, RLX))
THREAD(sb2, W(y, 1, RLX); r.b = R(x, RLX))
THREAD(sb1_ra, W(x, 1, REL); r.a = R(y, ACQ))
THREAD(sb2_ra, W(y, 1, REL); r.b = R(x, ACQ))
THREAD(sb1_f, W(x, 1, RLX); F(SC); r.a = R(y, RLX))
THREAD(sb2_f, W(y, 1, RLX); F(SC); r.b = R(x, RLX))

/* Message passing: the flag y is seen, the data x not */
OUTCOME(flag_without_data, r.a == 1 && r.b == 0)
THREAD(mp_w, W(x, 1, RLX); W(y, 1, RLX))
THREAD(mp_w_rel, W(x, 1, RLX); W(y, 1, REL))
THREAD(mp_w_f, W(x, 1, RLX); F(REL); W(y, 1, RLX))
THREAD(mp_r, r.a = R(y, RLX); r.b = R(x, RLX))
THREAD(mp_r_acq, r.a = R(y, ACQ); r.b = R(x, RLX))
THREAD(mp_r_f, r.a = R(y, RLX); F(ACQ); r.b = R(x, RLX))

/* Release sequences: the flag counted on, by the same thread and by another */
OUTCOME(counted_without_data, r.a == 2 && r.b == 0)
THREAD(rs_w, W(x, 1, RLX); W(y, 1, REL); W(y, 2, RLX))
THREAD(rs_inc, INC(y, RLX))

/* Load buffering: each reads what the other stores afterwards */
OUTCOME(both_new, r.a == 1 && r.b == 1)
THREAD(lb1, r.a = R(x, RLX); W(y, 1, RLX))
THREAD(lb2, r.b = R(y, RLX); W(x, 1, RLX))

/* Independent readers of independent writers see them in opposite order */
OUTCOME(opposite, r.a == 1 && r.b == 0 && r.c == 1 && r.d == 0)
THREAD(w_x, W(x, 1, RLX))
THREAD(w_y, W(y, 1, RLX))
THREAD(w_x_rel, W(x, 1, REL))
THREAD(w_y_rel, W(y, 1, REL))
THREAD(ir1, r.a = R(x, ACQ); r.b = R(y, ACQ))
THREAD(ir2, r.c = R(y, ACQ); r.d = R(x, ACQ))
THREAD(ir1_f, r.a = R(x, RLX); F(SC); r.b = R(y, RLX))
THREAD(ir2_f, r.c = R(y, RLX); F(SC); r.d = R(x, RLX))

/* Coherence of one location */
OUTCOME(back, r.a == 1 && r.b == 0)
THREAD(corr, r.a = R(x, RLX); r.b = R(x, RLX))
OUTCOME(readers_disagree, r.a == 1 && r.b == 2 && r.c == 2 && r.d == 1)
THREAD(w_x2, W(x, 2, RLX))
THREAD(corr1, r.a = R(x, RLX); r.b = R(x, RLX))
THREAD(corr2, r.c = R(x, RLX); r.d = R(x, RLX))
OUTCOME(older_last, explore_last(&x) == 1)
THREAD(coww, W(x, 1, RLX); W(x, 2, RLX))
OUTCOME(own_lost, r.a == 0)
THREAD(cowr, W(x, 1, RLX); r.a = R(x, RLX))
OUTCOME(from_after, r.a == 1 && explore_last(&x) == 1)
THREAD(corw, r.a = R(x, RLX); W(x, 2, RLX))

/* 2+2W: both locations end with the first store of a thread */
OUTCOME(both_first, explore_last(&x) == 1 && explore_last(&y) == 1)
THREAD(ww1, W(x, 1, RLX); W(y, 2, RLX))
THREAD(ww2, W(y, 1, RLX); W(x, 2, RLX))
THREAD(ww1_rel, W(x, 1, REL); W(y, 2, REL))
THREAD(ww2_rel, W(y, 1, REL); W(x, 2, REL))
THREAD(ww1_f, W(x, 1, RLX); F(SC); W(y, 2, RLX))
THREAD(ww2_f, W(y, 1, RLX); F(SC); W(x, 2, RLX))

/* S and R: a store against a store, with a read on one side */
OUTCOME(s_weak, r.a == 1 && explore_last(&x) == 2)
THREAD(s_w, W(x, 2, RLX); W(y, 1, RLX))
THREAD(s_w_rel, W(x, 2, RLX); W(y, 1, REL))
THREAD(s_r, r.a = R(y, RLX); W(x, 1, RLX))
THREAD(s_r_acq, r.a = R(y, ACQ); W(x, 1, RLX))
OUTCOME(r_weak, explore_last(&y) == 2 && r.a == 0)
THREAD(r_w, W(x, 1, REL); W(y, 1, REL))
THREAD(r_r, W(y, 2, REL); r.a = R(x, ACQ))
THREAD(r_w_f, W(x, 1, RLX); F(SC); W(y, 1, RLX))
THREAD(r_r_f, W(y, 2, RLX); F(SC); r.a = R(x, RLX))

/* Causality through a third thread */
OUTCOME(effect_without_cause, r.a == 1 && r.b == 1 && r.c == 0)
THREAD(wrc_m, r.a = R(x, RLX); W(y, 1, RLX))
THREAD(wrc_m_ra, r.a = R(x, ACQ); W(y, 1, REL))
THREAD(wrc_r, r.b = R(y, RLX); r.c = R(x, RLX))
THREAD(wrc_r_acq, r.b = R(y, ACQ); r.c = R(x, RLX))
THREAD(isa_w, W(z, 1, RLX); W(x, 1, REL))
THREAD(isa_r, r.b = R(y, ACQ); r.c = R(z, RLX))

/* Read-modify-writes take turns */
OUTCOME(lost_count, explore_last(&x) != 2 || r.a == r.b)
THREAD(inc1, r.a = INC(x, RLX))
THREAD(inc2, r.b = INC(x, RLX))
OUTCOME(two_owners, r.a == 1 && r.b == 1)
THREAD(cas1, uint32_t free = 0; r.a = __atomic_compare_exchange_n(&x, &free, 1, false, RLX, RLX))
THREAD(cas2, uint32_t free = 0; r.b = __atomic_compare_exchange_n(&x, &free, 2, false, RLX, RLX))

enum verdict { FORBIDDEN, ALLOWED, CPP20 /* allowed there, forbidden in C17 */ };
static const struct litmus {
	const char *name;
	enum verdict verdict;
	void (*outcome)(void);
	void (*run[THREADS])(void);
} tests[] = {
	{"SB, relaxed", ALLOWED, both_old, {sb1, sb2}},
	{"SB, release and acquire", ALLOWED, both_old, {sb1_ra, sb2_ra}},
	{"SB, fences", FORBIDDEN, both_old, {sb1_f, sb2_f}},
	{"SB, one fence", ALLOWED, both_old, {sb1_f, sb2}},
	{"MP, relaxed", ALLOWED, flag_without_data, {mp_w, mp_r}},
	{"MP, release and acquire", FORBIDDEN, flag_without_data, {mp_w_rel, mp_r_acq}},
	{"MP, release alone", ALLOWED, flag_without_data, {mp_w_rel, mp_r}},
	{"MP, acquire alone", ALLOWED, flag_without_data, {mp_w, mp_r_acq}},
	{"MP, fences", FORBIDDEN, flag_without_data, {mp_w_f, mp_r_f}},
	{"MP, release fence and acquire load", FORBIDDEN, flag_without_data, {mp_w_f, mp_r_acq}},
	{"MP, release store and acquire fence", FORBIDDEN, flag_without_data, {mp_w_rel, mp_r_f}},
	{"MP, release fence alone", ALLOWED, flag_without_data, {mp_w_f, mp_r}},
	{"MP, acquire fence alone", ALLOWED, flag_without_data, {mp_w, mp_r_f}},
	{"release sequence of one thread", CPP20, counted_without_data, {rs_w, mp_r_acq}},
	{"release sequence with an increment",
         FORBIDDEN,
         counted_without_data,
         {mp_w_rel, rs_inc, mp_r_acq}},
	{"LB, relaxed", FORBIDDEN, both_new, {lb1, lb2}},
	{"IRIW, release and acquire", ALLOWED, opposite, {w_x_rel, w_y_rel, ir1, ir2}},
	{"IRIW, fences", FORBIDDEN, opposite, {w_x, w_y, ir1_f, ir2_f}},
	{"CoRR", FORBIDDEN, back, {w_x, corr}},
	{"CoRR, two writers", FORBIDDEN, readers_disagree, {w_x, w_x2, corr1, corr2}},
	{"CoWW", FORBIDDEN, older_last, {coww}},
	{"CoWR", FORBIDDEN, own_lost, {cowr, w_x2}},
	{"CoRW", FORBIDDEN, from_after, {corw, w_x}},
	{"2+2W, relaxed", ALLOWED, both_first, {ww1, ww2}},
	{"2+2W, release", ALLOWED, both_first, {ww1_rel, ww2_rel}},
	{"2+2W, fences", FORBIDDEN, both_first, {ww1_f, ww2_f}},
	{"S, relaxed", ALLOWED, s_weak, {s_w, s_r}},
	{"S, release and acquire", FORBIDDEN, s_weak, {s_w_rel, s_r_acq}},
	{"R, release and acquire", ALLOWED, r_weak, {r_w, r_r}},
	{"R, fences", FORBIDDEN, r_weak, {r_w_f, r_r_f}},
	{"WRC, relaxed", ALLOWED, effect_without_cause, {w_x, wrc_m, wrc_r}},
	{"WRC, release and acquire",
         FORBIDDEN,
         effect_without_cause,
         {w_x_rel, wrc_m_ra, wrc_r_acq}},
	{"ISA2, release and acquire", FORBIDDEN, effect_without_cause, {isa_w, wrc_m_ra, isa_r}},
	{"two increments", FORBIDDEN, lost_count, {inc1, inc2}},
	{"two claims by compare-and-swap", FORBIDDEN, two_owners, {cas1, cas2}},
};

static bool run(const struct litmus *test, struct tally *tally)
{
	struct scenario scenario = {.name = test->name, .setup = setup, .end = test->outcome};
	struct exploration result;

	memcpy(scenario.run, test->run, sizeof(scenario.run));
	while (scenario.threads < THREADS && scenario.run[scenario.threads])
		scenario.threads++;
	happened = false;
	explore(&scenario, NULL, 31, false, &result);
	tally->states += result.states;
	return happened;
}

void litmus_run(struct tally *tally)
{
	for (size_t i = 0; i < sizeof(tests) / sizeof(tests[0]); i++) {
		bool cpp20, c17;

		weak_stores_go_on = false;
		cpp20 = run(&tests[i], tally);
		weak_stores_go_on = true;
		c17 = run(&tests[i], tally);
		weak_stores_go_on = false;
		tally_test(tally,
		           cpp20 == (tests[i].verdict != FORBIDDEN) &&
		                   c17 == (tests[i].verdict == ALLOWED),
		           "litmus %s: %s%s", tests[i].name, cpp20 ? "allowed" : "forbidden",
		           c17 != cpp20 ? ", in C17 the other way round" : "");
	}
}
