/* SPDX-License-Identifier: MIT */
/* The clock of the simulated loggers. */
#include "hal/sim/chips/logger.h"
#include "hal/base/time.h"

enum { TWELVE = 0x40, PM = 0x20, CENTURY = 0x80 };

static uint8_t to_bcd(int64_t value)
{
	return (uint8_t)(value / 10 << 4 | value % 10);
}

static int from_bcd(uint8_t bcd)
{
	return (bcd >> 4) * 10 + (bcd & 15);
}

/* Every fourth year is a leap year: the chips say so of 1900 too. */
static int64_t days_before(int year, int month)
{
	static const uint16_t before[] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334};

	return year * 365 + (year + 3) / 4 + before[month] + (year % 4 == 0 && month > 1);
}

static int64_t elapsed(const struct sim_clock *clock, int64_t t)
{
	return clock->stopped >= 0 ? clock->stopped : t - clock->zero;
}

void sim_clock_get(const struct sim_clock *clock, int64_t t, uint8_t bcd[SIM_TIME])
{
	int64_t seconds = elapsed(clock, t) / NS_PER_S, days = seconds / 86400;
	int hour = (int)(seconds / 3600 % 24), year = (int)(days * 4 / 1461) % 200, month = 11;

	bcd[SIM_SECONDS] = to_bcd(seconds % 60);
	bcd[SIM_MINUTES] = to_bcd(seconds / 60 % 60);
	bcd[SIM_HOURS] = to_bcd(hour);
	if (clock->twelve)
		bcd[SIM_HOURS] = (uint8_t)(to_bcd((hour + 11) % 12 + 1) | TWELVE |
		                           (hour >= 12 ? PM : 0));
	bcd[SIM_DAY] = (uint8_t)((clock->day + days) % 7 + 1);
	while (days_before(year, month) > days)
		month--;
	bcd[SIM_DATE] = to_bcd(days - days_before(year, month) + 1);
	bcd[SIM_MONTH] = (uint8_t)(to_bcd(month + 1) | (year >= 100 ? CENTURY : 0));
	bcd[SIM_YEAR] = to_bcd(year % 100);
}

static int hour_of(uint8_t bcd)
{
	if (!(bcd & TWELVE))
		return from_bcd(bcd & 0x3F);
	return from_bcd(bcd & 0x1F) % 12 + (bcd & PM ? 12 : 0);
}

void sim_clock_set(struct sim_clock *clock, int64_t t, const uint8_t bcd[SIM_TIME])
{
	int month = from_bcd(bcd[SIM_MONTH] & 0x1F);
	int year = from_bcd(bcd[SIM_YEAR]) + (bcd[SIM_MONTH] & CENTURY ? 100 : 0);
	int64_t days = days_before(year % 200, month < 1 || month > 12 ? 0 : month - 1) +
	               from_bcd(bcd[SIM_DATE]) - 1;
	int64_t since = ((days * 24 + hour_of(bcd[SIM_HOURS])) * 60 + from_bcd(bcd[SIM_MINUTES])) *
	                        60 +
	                from_bcd(bcd[SIM_SECONDS]);

	clock->twelve = (bcd[SIM_HOURS] & TWELVE) != 0;
	clock->day = (uint8_t)(((bcd[SIM_DAY] + 6 - days) % 7 + 7) % 7);
	clock->zero = t - since * NS_PER_S;
	if (clock->stopped >= 0)
		clock->stopped = since * NS_PER_S;
}

void sim_clock_init(struct sim_clock *clock)
{
	static const uint8_t new_year[SIM_TIME] = {0, 0, 0, 1, 1, 0x81, 0};

	clock->stopped = -1;
	sim_clock_set(clock, 0, new_year);
}

void sim_clock_run(struct sim_clock *clock, int64_t t, bool run)
{
	if (run && clock->stopped >= 0)
		clock->zero = t - clock->stopped;
	else if (!run && clock->stopped < 0)
		clock->stopped = t - clock->zero;
	if (run)
		clock->stopped = -1;
}
