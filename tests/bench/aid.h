/* SPDX-License-Identifier: MIT */
/*
 * What the benches share: time, placement, the line a figure is printed on, and the peer: the
 * genuine owserver with fake thermometers, asked over a bare socket.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "src/memory/shm/dir.h"

int64_t bench_now(void); /* ns, monotonic */
/* Keep this thread on one CPU; false when the machine has no such CPU. */
bool bench_pin(int cpu);
int bench_cpus(void);
/* "name value unit" */
void bench_line(const char *name, double value, const char *unit);
/* A line that is no figure: what was left out, and why. */
void bench_note(const char *text);
/* The p-th percentile (50: the median); sorts. */
double bench_percentile(double *values, size_t n, double p);
/* "name.p99 value unit" and so on, from the least (p0) to the largest (p100). */
void bench_distribution(const char *name, double *values, size_t n, const char *unit);
/* CPU time a process has used, ns (user and system, by the kernel's ticks). */
int64_t bench_cpu_ns(pid_t pid);

/* A program, its standard input and output if they are not less than 0; ended with the bench. */
pid_t bench_start(const char *program, const char *const arguments[], int in, int out);
void bench_stop(pid_t pid, int signal);

/*
 * A place of the bench's own for owsd and libows, in memory as a real one; removed with all that is
 * in it when the bench ends.
 */
const struct shm_dir *bench_dir(void);

struct bench_peer {
	pid_t pid;
	int port;
	unsigned devices;
	char (*paths)[32]; /* "/28.xxx/temperature" */
	char folder[64];
};
/* False: owserver is not installed or did not start; the reason was noted. */
bool bench_peer_start(struct bench_peer *peer, unsigned devices, int cpu);
void bench_peer_end(struct bench_peer *peer);

/*
 * A bare persistent connection: one request on its way at a time, nothing checked but the length.
 */
int bench_socket(int port);
/*
 * A connection for one read. They come from addresses of 127.1.0.0/16 in turn: where many
 * connections of one address have just ended, the kernel looks long for a free port.
 */
int bench_socket_once(int port);
/* Returns the length of the answer or -1. */
int bench_read(int fd, const char *path, char *data, size_t size);
bool bench_write(int fd, const char *path, const char *text);
/* The two halves of a reading. */
bool bench_send(int fd, const char *path);
/* The connection ends with the answer. */
bool bench_send_once(int fd, const char *path);
int bench_receive(int fd, char *data, size_t size);
/* A port that is free now. */
int bench_port(void);
