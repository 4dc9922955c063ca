/* SPDX-License-Identifier: MIT */
/*
 * The protocol of the shared memory, checked in every order and with everything that a weak memory
 * may show: first the checker by programs of which the answer is known, then the code, then the
 * code with each of its orders and fences weakened in turn, which must be found out.
 */
#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tests/model/suites.h"

void tally_test(struct tally *tally, bool passed, const char *format, ...)
{
	va_list args;

	printf(passed ? "ok   " : "FAIL ");
	va_start(args, format);
	vprintf(format, args);
	va_end(args);
	printf("\n");
	fflush(stdout);
	if (passed)
		tally->passed++;
	else
		tally->failed++;
}

#define SCENARIOS_MAX 31 /* bits of site.scenarios */
static const struct scenario *scenarios[SCENARIOS_MAX];
static unsigned scenario_count;

static void run_scenarios(const struct scenario *list, struct tally *tally)
{
	for (; list->name; list++) {
		struct exploration result;

		assert(scenario_count < SCENARIOS_MAX);
		scenarios[scenario_count] = list;
		explore(list, NULL, scenario_count++, true, &result);
		tally->states += result.states;
		tally->steps += result.steps;
		tally_test(tally, !result.failed && !result.too_large, "%s: %llu states%s",
		           list->name, (unsigned long long)result.states,
		           result.too_large ? ", too many" : "");
	}
}

static void run_wrong(const struct scenario *s, struct tally *tally)
{
	for (; s->name; s++) {
		struct exploration result;

		explore(s, NULL, 29, false, &result);
		tally->states += result.states;
		tally->steps += result.steps;
		tally_test(tally, result.failed, "wrong: %s: %s", s->name,
		           result.failed ? result.why : "not found out");
	}
}

/*
 * Weakened, these change nothing that the scenarios ask for. They stay: the thread sanitizer has no
 * fences, and there the order of the access is all there is.
 */
static const struct {
	const char *function, *way, *reason;
} spare[] = {
	{"entries_enter", "release to relaxed", "the fence in the entry does it too"},
	{"ows_alarm_count", "acquire to relaxed", "the fence behind the entry does it too"},
	{"image_awake", "seq_cst without release", "the fence behind it does it too"},
	{"image_awake", "seq_cst fence to acq_rel", "the fence of bells_close_eyes() does it too"},
	{"image_awake", "seq_cst fence taken away", "the fence of bells_close_eyes() does it too"},
	{"news_due", "release to relaxed", "the fence of control_news() stands before it"},
	{"controller_state", "seq_cst without release", "the fence behind it does it too"},
	{"ows_acknowledge", "release to relaxed", "the mark after it does it too"},
	{"changes_look", "acquire to relaxed", "handle_state() loads it again"},
	{"ows_shelve", "acquire to relaxed", "no store comes before a load here"},
};

static const char *spare_reason(const struct site *site, const char *way)
{
	for (size_t i = 0; i < sizeof(spare) / sizeof(spare[0]); i++)
		if (strcmp(spare[i].function, site->function) == 0 &&
		    strcmp(spare[i].way, way) == 0)
			return spare[i].reason;
	return NULL;
}

/* A header is named from the folder of the makefile, with "./" before it. */
static const char *file_of(const struct site *site)
{
	return strncmp(site->file, "./", 2) == 0 ? site->file + 2 : site->file;
}

static void run_mutant(const struct mutant *mutant, struct tally *tally)
{
	const struct site *site = mutant->site;
	const char *way = explore_way(site, mutant->way);
	const char *reason = spare_reason(site, way);
	struct exploration result = {0};
	unsigned i;

	for (i = 0; i < scenario_count && !result.failed; i++) {
		if (!(site->scenarios & 1u << i))
			continue;
		explore(scenarios[i], mutant, i, false, &result);
		tally->states += result.states;
		tally->steps += result.steps;
	}
	tally_test(tally, result.failed == (reason == NULL), "%s:%d %s: %s: %s", file_of(site),
	           site->line, site->function, way,
	           result.failed ? result.why
	           : reason      ? reason
	                         : "not found out");
}

static void run_mutants(struct tally *tally)
{
	bool headers = false;

	for (struct site *site = explore_sites(); site; site = site->next) {
		struct mutant mutant = {.site = site};

		if (!(site->scenarios & ((1u << scenario_count) - 1)) ||
		    strncmp(file_of(site), "src/", 4) != 0)
			continue;
		headers = headers || strcmp(file_of(site), "src/memory/shm/reader.h") == 0;
		for (; explore_way(site, mutant.way); mutant.way++)
			run_mutant(&mutant, tally);
	}
	tally_test(tally, headers, "accesses in headers are weakened too");
}

int main(void)
{
	struct tally tally = {0};

	litmus_run(&tally);
	run_scenarios(record_scenarios, &tally);
	record_pairs(&tally);
	run_scenarios(command_scenarios, &tally);
	run_scenarios(change_scenarios, &tally);
	run_wrong(wrong_scenarios, &tally);
	run_wrong(wrong_changes, &tally);
	run_mutants(&tally);
	printf("%llu states, %llu steps\n", (unsigned long long)tally.states,
	       (unsigned long long)tally.steps);
	printf("%u passed, %u failed\n", tally.passed, tally.failed);
	return tally.failed != 0;
}
