/* SPDX-License-Identifier: MIT */
/* Listening where another process has the port: a killed owsd that is stuck, or any other. */
#include <errno.h>
#include <netinet/in.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "src/daemon/serve/listener.h"
#include "src/daemon/serve/serve.h"
#include "src/ground/service/listen.h"
#include "tests/unit/aid/corpse.h"

static struct config_target target = {.text = "null:"};
static struct config config;
static struct sockaddr_storage to;
static struct serve *serve;
static int holder;
static char why[256];

static void no_ring(void *ctx)
{
	(void)ctx;
}

/* A port of 127.0.0.1 that this process holds. */
void setUp(void)
{
	struct sockaddr_in *v4 = (struct sockaddr_in *)&to;
	socklen_t len = sizeof(to);

	to = (struct sockaddr_storage){0};
	*v4 = (struct sockaddr_in){.sin_family = AF_INET,
	                           .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	holder = listen_at_address(&to, true, false);
	TEST_ASSERT_GREATER_OR_EQUAL(0, holder);
	TEST_ASSERT_EQUAL(0, getsockname(holder, (struct sockaddr *)&to, &len));
	config = (struct config){.targets = &target, .target_count = 1, .serve.address_count = 1};
	TEST_ASSERT_TRUE(listen_of((struct sockaddr *)&to, &config.serve.addresses[0]));
	corpse_own_name();
	serve = NULL;
}

void tearDown(void)
{
	if (holder >= 0)
		close(holder);
	serve_destroy(serve);
}

static int create(void)
{
	const struct serve_setup setup = {
		.config = &config, .instance = "corpse", .directory = -1, .ring = no_ring};

	return serve_create(&setup, &serve, why, sizeof(why));
}

/* 0, or the errno of a client that connects there. */
static int dial(void)
{
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	int err = connect(fd, (struct sockaddr *)&to, sizeof(struct sockaddr_in)) ? errno : 0;

	close(fd);
	return err;
}

static void test_a_port_of_another_program_is_an_error(void)
{
	TEST_ASSERT_EQUAL(-EADDRINUSE, create());
	TEST_ASSERT_NOT_NULL(strstr(why, "cannot listen at 127.0.0.1:"));
	TEST_ASSERT_NOT_NULL(strstr(why, "ss -ltnp"));
}

static void test_a_port_of_a_killed_owsd_that_is_stuck_is_taken_once_it_is_free(void)
{
	char absent[LISTEN_WHY_MAX];
	struct corpse corpse;

	corpse_make(&corpse, NULL);
	close(holder);
	holder = -1;
	TEST_ASSERT_EQUAL_MESSAGE(0, create(), why);
	TEST_ASSERT_EQUAL(-EADDRINUSE, listeners_look(serve, 0));
	for (int i = 0; i < 2; i++) {
		TEST_ASSERT_EQUAL(1, serve_absent(serve, absent));
		TEST_ASSERT_NOT_NULL(strstr(absent, "cannot listen at 127.0.0.1:"));
	}
	corpse_end(&corpse);
	TEST_ASSERT_EQUAL(ECONNREFUSED, dial());
	TEST_ASSERT_EQUAL(0, serve_absent(serve, absent));
	TEST_ASSERT_EQUAL_STRING("", absent);
	TEST_ASSERT_EQUAL(0, dial());
}

static void test_a_port_that_never_became_free_is_no_trouble_at_the_end(void)
{
	struct corpse corpse;

	corpse_make(&corpse, NULL);
	TEST_ASSERT_EQUAL_MESSAGE(0, create(), why);
	serve_stop(serve);
	corpse_end(&corpse);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_port_of_another_program_is_an_error);
	RUN_TEST(test_a_port_of_a_killed_owsd_that_is_stuck_is_taken_once_it_is_free);
	RUN_TEST(test_a_port_that_never_became_free_is_no_trouble_at_the_end);
	return UNITY_END();
}
