/* SPDX-License-Identifier: MIT */
/* What is said of an instance in a line: made, written, and read from others. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/kit/body.h"
#include "src/faces/show/present.h"
#include "src/faces/web/summary.h"
#include "src/ground/signal/utf8.h"

#define MOST 4000000000u /* of any number */

/* What the two functions below have in common: the members, and where they are. */
#define AT(member) offsetof(struct summary, member)
#define SIZE(member) sizeof(((struct summary *)NULL)->member)
static const struct {
	const char *key;
	size_t at, size;
} texts[] = {
	{"instance", AT(instance), SIZE(instance)}, {"host", AT(host), SIZE(host)},
	{"version", AT(version), SIZE(version)},    {"first", AT(first), SIZE(first)},
	{"alarm", AT(alarm), SIZE(alarm)},
};
static const struct {
	const char *key;
	size_t at;
} numbers[] = {
	{"signals", AT(signals)},
	{"not_good", AT(not_good)},
	{"alarms", AT(alarms)},
	{"needs", AT(needs)},
};
#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* --- Of this machine ------------------------------------------------------------------------- */

static bool is_very(const char *words)
{
	return strstr(words, "high high") || strstr(words, "low low");
}

static void add_alarm(struct summary *summary, const struct ows_alarm_state *state,
                      const char *name)
{
	char words[STANDING_WORDS];

	summary->alarms++;
	standing_text(state, words);
	if (*summary->first && (is_very(summary->alarm) || !is_very(words)))
		return;
	snprintf(summary->first, sizeof(summary->first), "%s", name);
	snprintf(summary->alarm, sizeof(summary->alarm), "%s", words);
}

static void add_signal(struct summary *summary, struct ows *h, int signal, int id, int64_t now_ns)
{
	struct ows_alarm_state state;
	struct ows_value value = {0};
	struct ows_info info;
	bool good = ows_get_signal(h, signal, now_ns, &value) == 0 && ows_good(value.quality);
	bool waits = false;

	if (id >= 0 && !ows_info(h, signal, &info)) {
		state = standing_of(h, id);
		waits = standing_wants_eyes(&state);
		if (waits)
			add_alarm(summary, &state, info.name);
	}
	summary->signals++;
	summary->not_good += !good;
	/* what was never read yet is not wrong */
	summary->needs += good ? waits : value.quality != OWS_Q_INITIAL;
}

void summary_make(struct summary *summary, const char *instance, struct ows *h, bool live,
                  const int *ids, int64_t now_ns)
{
	struct ows_daemon daemon;

	*summary = (struct summary){.live = live, .up_s = -1};
	snprintf(summary->instance, sizeof(summary->instance), "%s", instance);
	snprintf(summary->version, sizeof(summary->version), "%s", OWSD_VERSION);
	gethostname(summary->host, sizeof(summary->host) - 1);
	if (!live) {
		summary->signals = summary->not_good = summary->needs = h ? (uint32_t)ows_count(h)
		                                                          : 0;
		return;
	}
	if (ows_daemon(h, now_ns, &daemon) == 0)
		summary->up_s = (now_ns - daemon.start_ns) / NS_PER_S;
	for (int i = 0; i < ows_count(h); i++)
		add_signal(summary, h, i, ids ? ids[i] : -1, now_ns);
}

void summary_json(struct json *json, const struct summary *summary)
{
	const char *base = (const char *)summary;

	for (size_t i = 0; i < COUNT(texts); i++)
		json_string(json, texts[i].key, base[texts[i].at] ? base + texts[i].at : NULL);
	json_bool(json, "live", summary->live);
	for (size_t i = 0; i < COUNT(numbers); i++)
		json_uint(json, numbers[i].key, *(const uint32_t *)(base + numbers[i].at));
	if (summary->up_s < 0)
		json_null(json, "up");
	else
		json_int(json, "up", summary->up_s);
}

/* --- Of others ------------------------------------------------------------------------------- */

static bool take_text(const struct body *body, const char *key, char *to, size_t size)
{
	const struct body_member *member = body_find(body, key);
	const char *text = body_string(body, key);
	size_t left = strlen(text);

	if (!member || (member->kind != BODY_STRING && member->kind != BODY_NULL) || left >= size)
		return false;
	memcpy(to, text, left + 1);
	while (left)
		if (utf8_disturbs(utf8_next(&text, &left)))
			return false;
	return true;
}

/* A whole number. */
static bool take_number(const struct body *body, const char *key, uint32_t *number)
{
	const struct body_member *member = body_find(body, key);
	unsigned long long value;

	if (!member || member->kind != BODY_NUMBER || strlen(member->text) > 10 ||
	    strspn(member->text, "0123456789") != strlen(member->text))
		return false;
	value = strtoull(member->text, NULL, 10);
	*number = (uint32_t)value;
	return value <= MOST;
}

int summary_parse(char *text, size_t len, struct summary *summary)
{
	const struct body_member *live, *up;
	char *base = (char *)summary;
	struct body body;
	uint32_t seconds;

	*summary = (struct summary){.up_s = -1};
	if (body_parse(text, len, &body))
		return -EBADMSG;
	for (size_t i = 0; i < COUNT(texts); i++)
		if (!take_text(&body, texts[i].key, base + texts[i].at, texts[i].size))
			return -EBADMSG;
	for (size_t i = 0; i < COUNT(numbers); i++)
		if (!take_number(&body, numbers[i].key, (uint32_t *)(base + numbers[i].at)))
			return -EBADMSG;
	live = body_find(&body, "live");
	up = body_find(&body, "up");
	if (!live || (live->kind != BODY_TRUE && live->kind != BODY_FALSE) || !up)
		return -EBADMSG;
	summary->live = live->kind == BODY_TRUE;
	if (up->kind != BODY_NULL) {
		if (!take_number(&body, "up", &seconds))
			return -EBADMSG;
		summary->up_s = seconds;
	}
	return summary->needs > summary->signals || summary->alarms > summary->signals ||
	                       summary->not_good > summary->signals
	               ? -EBADMSG
	               : 0;
}
