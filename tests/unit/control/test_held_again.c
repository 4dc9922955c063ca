/* SPDX-License-Identifier: MIT */
/* What a controller had is given back whole: after a reload, and where it still writes there. */
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/control/private.h"
#include "tests/unit/aid/control_scene.h"

void setUp(void)
{
	control_open();
}

void tearDown(void)
{
	control_close();
}

static unsigned held(void)
{
	unsigned n;

	pthread_mutex_lock(&control_room->lock);
	n = control_room->held_count;
	pthread_mutex_unlock(&control_room->lock);
	return n;
}

static void wait_held(unsigned count)
{
	for (int ms = 0; held() != count && ms < CONTROL_SCENE_MS; ms++)
		nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL); /* pace */
	TEST_ASSERT_EQUAL_UINT(count, held());
}

static void test_a_memory_stays_two_seconds_after_a_reload_though_the_thread_slept_before(void)
{
	struct control_client client;
	int64_t left_ns;

	TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "idle"));
	/* so late was its last turn */
	pthread_mutex_lock(&control_room->lock);
	control_room->now_ns -= 60 * NS_PER_S;
	pthread_mutex_unlock(&control_room->lock);
	control_reload();
	pthread_mutex_lock(&control_room->lock);
	left_ns = control_room->held_count ? control_room->held[0].until_ns - ows_now() : 0;
	pthread_mutex_unlock(&control_room->lock);
	TEST_ASSERT_GREATER_THAN_INT64(NS_PER_S, left_ns);
	control_leave(&client);
}

static atomic_bool ends;

static void *write_without_pause(void *memory)
{
	while (!atomic_load(&ends))
		*(volatile char *)memory = 1;
	return NULL;
}

/* Returns whether owsd kept the memory while its program wrote there; it is given back after. */
static bool is_kept_while_written(void)
{
	struct control_client client;
	pthread_t writer;
	uint32_t at = 1;
	bool kept;

	TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "late"));
	while (!client.memory[at] && at < 1024)
		at++;
	TEST_ASSERT_LESS_THAN_UINT(1024, at);
	atomic_store(&ends, false);
	TEST_ASSERT_EQUAL(0, pthread_create(&writer, NULL, write_without_pause, client.memory));
	close(client.fd);
	client.fd = -1;
	control_wait_count("control_connections", 0);
	/* the porter has emptied it once, and its page is back */
	for (int ms = 0; ((volatile char *)client.memory)[at] && ms < CONTROL_SCENE_MS; ms++)
		nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL); /* pace */
	TEST_ASSERT_EQUAL(0, client.memory[at]);
	nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL); /* pace */
	kept = held() == 1;
	atomic_store(&ends, true);
	pthread_join(writer, NULL);
	wait_held(0);
	control_leave(&client);
	return kept;
}

/* A writer that does not run for a moment leaves it empty, and that is all that owsd asks. */
static void test_a_memory_in_which_its_program_still_writes_is_emptied_again(void)
{
	for (int i = 0; i < 20; i++)
		if (is_kept_while_written())
			return;
	TEST_FAIL_MESSAGE("it is never kept");
}

static void test_memories_keep_slots_of_their_own_while_others_go(void)
{
	struct control_client clients[3];
	bool taken[PORTER_SLOTS] = {false};
	uint32_t slots[CONTROL_HELD_ALL];

	for (int i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL(0, control_join(&clients[i], OWS_HELLO_COMMAND, "x"));
	control_reload();
	control_leave(&clients[1]);
	control_reload();
	wait_held(0);
	pthread_mutex_lock(&control_room->lock);
	for (unsigned i = 0; i < CONTROL_HELD_ALL; i++)
		slots[i] = control_room->held[i].slot;
	pthread_mutex_unlock(&control_room->lock);
	for (unsigned i = 0; i < CONTROL_HELD_ALL; i++) {
		uint32_t slot = slots[i];

		TEST_ASSERT_LESS_THAN_UINT(PORTER_SLOTS, slot);
		TEST_ASSERT_GREATER_OR_EQUAL_UINT(OWS_CONTROLLERS, slot);
		TEST_ASSERT_FALSE(taken[slot]);
		taken[slot] = true;
	}
	control_leave(&clients[0]);
	control_leave(&clients[2]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_memory_stays_two_seconds_after_a_reload_though_the_thread_slept_before);
	RUN_TEST(test_a_memory_in_which_its_program_still_writes_is_emptied_again);
	RUN_TEST(test_memories_keep_slots_of_their_own_while_others_go);
	return UNITY_END();
}
