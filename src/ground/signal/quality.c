/* SPDX-License-Identifier: MIT */
/* What a quality that is not good means, or an alarm of a device, and what to do. */
#include <stddef.h>

#include "src/ground/signal/quality.h"
#include "src/public/ows.h"

static const struct {
	uint8_t quality;
	enum device_health health;
	const char *cause, *remedy;
} table[] = {
#define QUALITY(code, health, word, cause, remedy) {OWS_Q_##code, HEALTH_##health, cause, remedy},
#define ERROR(err, word, remedy)
#define ALARM(kind, event, word, cause, remedy)
#include "src/ground/signal/words_list.h"
#undef ALARM
#undef ERROR
#undef QUALITY
};
#define QUALITIES (sizeof(table) / sizeof(table[0]))

static size_t quality_find(uint8_t quality)
{
	size_t i = 0;

	while (i < QUALITIES && table[i].quality != quality)
		i++;
	return i;
}

const char *quality_cause(uint8_t quality)
{
	size_t i = quality_find(quality);

	return i < QUALITIES ? table[i].cause : "";
}

enum device_health quality_health(uint8_t quality)
{
	size_t i = quality_find(quality);

	return i < QUALITIES ? table[i].health : ows_good(quality) ? HEALTH_NORMAL : HEALTH_FAILURE;
}

const char *health_word(enum device_health health)
{
	static const char *const words[] = {
		[HEALTH_NORMAL] = "normal",
		[HEALTH_FAILURE] = "failure",
		[HEALTH_CHECK] = "check function",
		[HEALTH_OFF_SPEC] = "off spec",
		[HEALTH_MAINTENANCE] = "maintenance required",
	};

	return words[health];
}

const char *quality_remedy(uint8_t quality)
{
	size_t i = quality_find(quality);

	return i < QUALITIES ? table[i].remedy : "";
}

static const struct {
	uint8_t kind, event;
	const char *word, *cause, *remedy;
} alarms[] = {
#define QUALITY(code, health, word, cause, remedy)
#define ERROR(err, word, remedy)
#define ALARM(kind, event, word, cause, remedy) \
	{OWS_ALARM_##kind, OWS_ALARM_##event, word, cause, remedy},
#include "src/ground/signal/words_list.h"
#undef ALARM
#undef ERROR
#undef QUALITY
};
#define ALARMS (sizeof(alarms) / sizeof(alarms[0]))

static size_t alarm_find(uint8_t kind, uint8_t event)
{
	size_t i = 0;

	while (i < ALARMS && (alarms[i].kind != kind || alarms[i].event != event))
		i++;
	return i;
}

const char *alarm_word(uint8_t kind, uint8_t event)
{
	size_t i = alarm_find(kind, event);

	return i < ALARMS ? alarms[i].word : "";
}

const char *alarm_cause(uint8_t kind, uint8_t event)
{
	size_t i = alarm_find(kind, event);

	return i < ALARMS ? alarms[i].cause : "";
}

const char *alarm_remedy(uint8_t kind, uint8_t event)
{
	size_t i = alarm_find(kind, event);

	return i < ALARMS ? alarms[i].remedy : "";
}
