/* SPDX-License-Identifier: MIT */
/*
 * Put before a source file (-include), this makes its atomic accesses and fences steps of the
 * model. The file itself is the one that the programs are built from. Each access knows where it
 * stands, so that it can be weakened there.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Enough for as many updates as there are in a scenario, or a reader gives up and is found out */
#define READER_TRIES 4

struct site {
	const char *file, *function;
	int line;
	struct site *same; /* the first that was met of this place; NULL: not yet met */
	struct site *next;
	int kind, order;
	unsigned scenarios; /* that came by: one bit for each */
};

enum access_rmw { ACCESS_ADD, ACCESS_SUB, ACCESS_OR, ACCESS_AND, ACCESS_SET };

uint64_t access_load(const volatile void *at, size_t size, int order, struct site *site);
void access_store(volatile void *at, size_t size, uint64_t value, int order, struct site *site);
/* Returns what was there before. */
uint64_t access_rmw(volatile void *at, size_t size, enum access_rmw how, uint64_t operand,
                    int order, struct site *site);
bool access_cas(volatile void *at, size_t size, uint64_t *expected, uint64_t value, int order,
                int failed, struct site *site);
void access_fence(int order, struct site *site);

/*
 * Descriptors of which the model is the kernel: eventfds and sockets that wake. write() and send()
 * ring; epoll waits for the first, ppoll() for the others until read(). The last one orders, as
 * eventfds do, what stands before a ring and after a read; no order of the others is relied on.
 */
enum access_bells { ACCESS_BELL = 1000, ACCESS_NEWS, ACCESS_ORDERING };
/* For setup; rings counts how often it rang, heard is what the sleeper knows of that. */
void access_bell(enum access_bells bell, uint32_t *rings, uint32_t *heard);

#define ACCESS_SITE \
	(__extension__({ \
		static struct site access_site = {.file = __FILE__, .line = __LINE__}; \
		access_site.function = __func__; \
		&access_site; \
	}))
#define ACCESS_TYPE(p) __typeof__(((void)0, *(p)))
/* A function, for its result may be left alone */
static inline uint32_t access_change(volatile uint32_t *at, enum access_rmw how, uint32_t operand,
                                     int order, struct site *site)
{
	return (uint32_t)access_rmw(at, sizeof(*at), how, operand, order, site);
}

#define __atomic_load_n(p, order) \
	((ACCESS_TYPE(p))access_load((p), sizeof(*(p)), (order), ACCESS_SITE))
#define __atomic_store_n(p, value, order) \
	access_store((p), sizeof(*(p)), (uint64_t)(value), (order), ACCESS_SITE)
/* clang-format off */
#define __atomic_fetch_add(p, n, order) \
	access_change((p), ACCESS_ADD, (n), (order), ACCESS_SITE)
#define __atomic_add_fetch(p, n, order) (__atomic_fetch_add(p, n, order) + (n))
#define __atomic_fetch_sub(p, n, order) \
	access_change((p), ACCESS_SUB, (n), (order), ACCESS_SITE)
#define __atomic_fetch_or(p, n, order) \
	access_change((p), ACCESS_OR, (n), (order), ACCESS_SITE)
#define __atomic_fetch_and(p, n, order) \
	access_change((p), ACCESS_AND, (n), (order), ACCESS_SITE)
#define __atomic_exchange_n(p, n, order) \
	access_change((p), ACCESS_SET, (n), (order), ACCESS_SITE)
/* clang-format on */
#define __atomic_compare_exchange_n(p, expected, value, weak, order, failed) \
	(__extension__({ \
		uint64_t access_expected = *(expected); \
		bool access_done = access_cas((p), sizeof(*(p)), &access_expected, (value), \
		                              (order), (failed), ACCESS_SITE); \
		*(expected) = (ACCESS_TYPE(p))access_expected; \
		access_done; \
	}))
#define __atomic_thread_fence(order) access_fence((order), ACCESS_SITE)
