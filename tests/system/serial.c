/* SPDX-License-Identifier: MIT */
/*
 * serial [--ds2480b] [--paced] [--strict] SCENARIO: a simulated serial adapter at a
 * pseudo-terminal, for owsd and for the genuine owserver and digitemp. Prints the name of the
 * pseudo-terminal, then serves it until it is ended. The adapter is a passive one (DS9097), or with
 * --ds2480b a DS9097U; its wire is channel 0 of the scenario's first chip.
 *
 * Bytes take the time of the line and of the wire; the clock of the simulation leaps over what the
 * host would have to wait, unless it is --paced. With --strict the program ends with status 3 when
 * the host has sent bytes faster than the adapter can carry them out.
 *
 * A line on standard input is a command, which is answered with a line: an event of a scenario
 * without its time ("unplug kitchen"), "silent on", "silent off", "noise N" (of each N-th answer a
 * bit is turned; 0: none), "unplug N" (end after so many more bytes, as an adapter that is pulled),
 * "stats".
 */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "hal/sim/event.h"
#include "hal/sim/scenario.h"
#include "hal/sim/serial/line.h"

static struct sim_net net;
static struct sim_serial serial;
static bool paced, strict;
static int64_t leapt_ns; /* over waiting */
static uint64_t pull_at; /* the adapter is pulled after this byte; 0: never */
static uint64_t turns;   /* so often the host went on after an answer */
static bool answered;

static int64_t now(void)
{
	struct timespec time;

	clock_gettime(CLOCK_MONOTONIC, &time);
	return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec + leapt_ns;
}

/* The speed that the host has set: the other side of the pseudo-terminal shows it. */
static uint32_t host_baud(int port)
{
	static const struct {
		speed_t speed;
		uint32_t baud;
	} speeds[] = {{B4800, 4800},   {B9600, 9600},   {B19200, 19200},
	              {B38400, 38400}, {B57600, 57600}, {B115200, 115200}};
	struct termios set;

	if (tcgetattr(port, &set))
		return 9600;
	for (size_t i = 0; i < sizeof(speeds) / sizeof(speeds[0]); i++)
		if (speeds[i].speed == cfgetospeed(&set))
			return speeds[i].baud;
	return 9600;
}

static void stats(void)
{
	const struct sim_wire *wire = &net.chip[0].wire[0];
	unsigned long long conversions = 0;

	for (size_t i = 0; i < wire->count; i++)
		conversions += wire->slaves[i]->conversions;
	printf("bytes %llu answers %llu overruns %llu resets %llu slots %llu conversions %llu "
	       "master_resets %llu turns %llu baud %u\n",
	       (unsigned long long)serial.bytes, (unsigned long long)serial.answered,
	       (unsigned long long)serial.overruns, (unsigned long long)wire->resets,
	       (unsigned long long)wire->slots, conversions,
	       (unsigned long long)serial.master_resets, (unsigned long long)turns, serial.baud);
}

static void command(const char *line)
{
	char why[256] = "ok";
	unsigned n;

	if (strcmp(line, "stats") == 0) {
		stats();
	} else {
		if (strncmp(line, "silent ", 7) == 0)
			serial.silent = strcmp(line + 7, "on") == 0;
		else if (sscanf(line, "noise %u", &n) == 1)
			serial.noise_each = n;
		else if (sscanf(line, "unplug %u", &n) == 1)
			pull_at = serial.bytes + n;
		else
			sim_scenario_event(&net, line, now(), why, sizeof(why));
		puts(why[0] ? why : "ok");
	}
	fflush(stdout);
}

/* Commands come whole, one at a time. False: nobody will send any more. */
static bool commands(void)
{
	char line[256];
	ssize_t n = read(STDIN_FILENO, line, sizeof(line) - 1);

	if (n <= 0)
		return false;
	line[n] = '\0';
	line[strcspn(line, "\n")] = '\0';
	command(line);
	return true;
}

static bool is_pulled(void)
{
	return pull_at && serial.bytes >= pull_at;
}

static void take_bytes(int port)
{
	uint8_t bytes[4096];
	ssize_t n = read(port, bytes, sizeof(bytes));
	uint32_t baud = host_baud(port);

	turns += n > 0 && answered;
	answered &= n <= 0;
	for (ssize_t i = 0; i < n && !is_pulled(); i++)
		sim_serial_send(&serial, bytes[i], baud, now());
}

/* Returns how long there is nothing to give, in ns; -1: for ever. */
static int64_t give_bytes(int port)
{
	uint32_t baud = host_baud(port);
	int64_t due;

	while ((due = sim_serial_due(&serial)) != INT64_MAX) {
		uint8_t byte;

		if (due > now() && paced)
			return due - now();
		if (due > now())
			leapt_ns += due - now();
		byte = sim_serial_take(&serial, baud);
		if (write(port, &byte, 1) != 1)
			break;
		answered = true;
	}
	return -1;
}

/* Until the adapter is pulled: the host closes and opens it as it likes. */
static int serve(int port)
{
	struct pollfd fds[2] = {{.fd = port, .events = POLLIN},
	                        {.fd = STDIN_FILENO, .events = POLLIN}};

	for (;;) {
		int64_t rest = give_bytes(port);
		struct timespec wait = {.tv_sec = rest / 1000000000, .tv_nsec = rest % 1000000000};

		if (strict && serial.overruns) {
			fputs("serial: overrun\n", stderr);
			return 3;
		}
		if (is_pulled())
			return 0;
		if (ppoll(fds, 2, rest < 0 ? NULL : &wait, NULL) < 0 && errno != EINTR)
			return 1;
		if (fds[0].revents)
			take_bytes(port);
		if (fds[1].revents && !commands())
			fds[1].fd = -1;
	}
}

/* The master's side of a new pseudo-terminal; this process keeps the other side open too. */
static int open_port(void)
{
	int port = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC), end;
	struct termios raw;

	if (port < 0 || grantpt(port) || unlockpt(port))
		return -1;
	end = open(ptsname(port), O_RDWR | O_NOCTTY | O_CLOEXEC);
	if (end < 0 || tcgetattr(end, &raw))
		return -1;
	cfmakeraw(&raw);
	cfsetspeed(&raw, B9600);
	return tcsetattr(end, TCSANOW, &raw) ? -1 : port;
}

int main(int argc, char **argv)
{
	enum sim_serial_kind kind = SIM_PASSIVE;
	char why[256];
	int port, i;

	for (i = 1; i < argc - 1; i++) {
		if (strcmp(argv[i], "--ds2480b") == 0)
			kind = SIM_DS2480B;
		else if (strcmp(argv[i], "--paced") == 0)
			paced = true;
		else if (strcmp(argv[i], "--strict") == 0)
			strict = true;
		else
			break;
	}
	if (i != argc - 1) {
		fprintf(stderr, "usage: serial [--ds2480b] [--paced] [--strict] SCENARIO\n");
		return 2;
	}
	if (sim_scenario_read(argv[i], &net, why, sizeof(why))) {
		fprintf(stderr, "%s\n", why);
		return 1;
	}
	port = open_port();
	if (port < 0) {
		perror("no pseudo-terminal");
		return 1;
	}
	sim_net_start(&net, now());
	sim_serial_init(&serial, kind, &net);
	puts(ptsname(port));
	fflush(stdout);
	return serve(port);
}
