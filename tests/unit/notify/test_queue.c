/* SPDX-License-Identifier: MIT */
/* Tests of the queue of owsd-notify. */
#include "unity.h"

#include "src/faces/notify/queue.h"
#include "src/faces/notify/ways.h"
#include "src/public/ows.h"

static struct queue queue;

void setUp(void)
{
	queue = (struct queue){0};
}

void tearDown(void)
{
}

static void test_the_oldest_go_and_numbers_stay(void)
{
	for (int i = 0; i < QUEUE_ENTRIES + 3; i++)
		queue_add(&queue)->came_ns = i;
	TEST_ASSERT_EQUAL_UINT64(3, queue.first);
	TEST_ASSERT_EQUAL_UINT64(QUEUE_ENTRIES + 3, queue.end);
	TEST_ASSERT_NULL(queue_at(&queue, 2));
	TEST_ASSERT_EQUAL_INT64(3, queue_at(&queue, 3)->came_ns);
	TEST_ASSERT_EQUAL_INT64(QUEUE_ENTRIES + 2, queue_at(&queue, queue.end - 1)->came_ns);
	TEST_ASSERT_NULL(queue_at(&queue, queue.end));
}

static void test_critical_ones_stay_before_others(void)
{
	for (int i = 0; i < QUEUE_ENTRIES; i++)
		*queue_add(&queue) = (struct entry){.came_ns = i, .critical = i != 2};
	TEST_ASSERT_EQUAL_UINT64(2, queue_leaves(&queue));
	queue_add(&queue)->critical = true;
	TEST_ASSERT_EQUAL_INT64(0, queue_at(&queue, 1)->came_ns);
	TEST_ASSERT_EQUAL_INT64(1, queue_at(&queue, 2)->came_ns);
	TEST_ASSERT_EQUAL_INT64(3, queue_at(&queue, 3)->came_ns);
	TEST_ASSERT_EQUAL_UINT64(1, queue_leaves(&queue));
}

static void test_a_way_counts_those_that_it_would_have_told(void)
{
	static struct ways ways;
	struct way *mail = &ways.way[WAY_MAIL], *post = &ways.way[WAY_POST];

	for (int i = 0; i < QUEUE_ENTRIES; i++)
		*ways_add(&ways) = (struct entry){.came_ns = i, .critical = i != 2};
	post->next = 1; /* it has told the first one */
	ways_add(&ways)->critical = true;
	TEST_ASSERT_EQUAL_UINT64(1, mail->missed);
	TEST_ASSERT_EQUAL_UINT64(0, ways.way[WAY_ESCALATE].missed);
	TEST_ASSERT_EQUAL_UINT64(1, mail->next);
	TEST_ASSERT_EQUAL_UINT64(2, post->next);
	TEST_ASSERT_EQUAL_INT64(1, queue_at(&ways.queue, post->next)->came_ns);
	/* all have told all: there is place, and none is lost */
	for (int i = 0; i < WAYS; i++)
		ways.way[i].next = ways.queue.end;
	ways_add(&ways);
	TEST_ASSERT_EQUAL_UINT64(1, mail->missed);
}

static void test_the_oldest_of_the_journal_is_found(void)
{
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, queue_oldest(&queue, 0, false));
	queue_add(&queue)->entered_ns = 5;
	queue_add(&queue);
	queue_add(&queue)->entered_ns = 9;
	queue_add(&queue)->entered_ns = 8;
	*queue_add(&queue) = (struct entry){.entered_ns = 4, .escalated = true};
	TEST_ASSERT_EQUAL_INT64(5, queue_oldest(&queue, 0, false));
	TEST_ASSERT_EQUAL_INT64(8, queue_oldest(&queue, 1, false));
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, queue_oldest(&queue, 4, false));
	TEST_ASSERT_EQUAL_INT64(4, queue_oldest(&queue, 0, true));
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, queue_oldest(&queue, 5, true));
}

static void test_an_end_is_of_one_signal_and_of_all_its_limits(void)
{
	*queue_add(&queue) = (struct entry){.signal = 1, .kind = OWS_ALARM_H};
	*queue_add(&queue) = (struct entry){.signal = 1, .kind = OWS_ALARM_HH};
	*queue_add(&queue) = (struct entry){.signal = 2, .kind = OWS_ALARM_H};
	*queue_add(&queue) = (struct entry){.signal = 1, .kind = OWS_ALARM_DEVICE};
	*queue_add(&queue) = (struct entry){.signal = 1};
	queue_ended(&queue, 1, OWS_ALARM_HH, "returned", 7);
	*queue_add(&queue) = (struct entry){.signal = 1, .kind = OWS_ALARM_H};
	queue_ended(&queue, 1, OWS_ALARM_H, "acknowledged", 9);
	queue_ended(&queue, 1, 0, "nothing", 10);
	TEST_ASSERT_EQUAL_STRING("returned", queue_at(&queue, 0)->ended);
	TEST_ASSERT_EQUAL_INT64(7, queue_at(&queue, 1)->ended_ns);
	TEST_ASSERT_NULL(queue_at(&queue, 2)->ended);
	TEST_ASSERT_NULL(queue_at(&queue, 3)->ended);
	TEST_ASSERT_NULL(queue_at(&queue, 4)->ended);
	TEST_ASSERT_EQUAL_INT64(9, queue_at(&queue, 5)->ended_ns);
}

static bool judge(void *ctx, struct entry *entry)
{
	return entry->came_ns != *(int64_t *)ctx;
}

/* Mail, at the time 100, in quiet hours or not: what is under way is given up. */
static bool begins(struct ways *ways, const char *quiet)
{
	struct config_notify notify = {.mail = "a", .sendmail = "/bin/true", .quiet = quiet};
	bool busy;

	ways_step(ways, &notify, -1, 0, 100);
	busy = ways->way[WAY_MAIL].busy;
	ways_close(ways);
	return busy;
}

static void test_what_waits_is_judged_again_when_it_can_be_told(void)
{
	static struct ways ways;
	int64_t out = 5;

	ways = (struct ways){.judge = judge, .judge_ctx = &out};
	*ways_add(&ways) = (struct entry){.came_ns = 5, .text = "a"};
	*ways_add(&ways) = (struct entry){.came_ns = 6, .text = "b"};
	TEST_ASSERT_FALSE(begins(&ways, "00:00-00:00")); /* all day */
	TEST_ASSERT_EQUAL_UINT64(0, ways.way[WAY_MAIL].next);
	ways.held = true;
	TEST_ASSERT_FALSE(begins(&ways, NULL));
	ways.held = false;
	TEST_ASSERT_TRUE(begins(&ways, NULL));
	TEST_ASSERT_EQUAL_UINT64(0, ways.way[WAY_MAIL].next);
	out = 6;
	queue_at(&ways.queue, 0)->came_ns = 6;
	TEST_ASSERT_FALSE(begins(&ways, NULL));
	TEST_ASSERT_EQUAL_UINT64(2, ways.way[WAY_MAIL].next);
}

static void test_a_recipient_that_is_gone_leaves_no_trouble(void)
{
	static const struct config_notify none;
	static struct ways ways;
	struct way *mail = &ways.way[WAY_MAIL];

	ways_add(&ways)->text[0] = 'a';
	snprintf(mail->why, sizeof(mail->why), "refused");
	mail->missed = 3;
	ways_step(&ways, &none, -1, 0, 100);
	TEST_ASSERT_EQUAL_STRING("", mail->why);
	TEST_ASSERT_EQUAL_UINT64(0, mail->missed);
	TEST_ASSERT_EQUAL_UINT64(1, mail->next);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_oldest_go_and_numbers_stay);
	RUN_TEST(test_critical_ones_stay_before_others);
	RUN_TEST(test_a_way_counts_those_that_it_would_have_told);
	RUN_TEST(test_the_oldest_of_the_journal_is_found);
	RUN_TEST(test_an_end_is_of_one_signal_and_of_all_its_limits);
	RUN_TEST(test_what_waits_is_judged_again_when_it_can_be_told);
	RUN_TEST(test_a_recipient_that_is_gone_leaves_no_trouble);
	return UNITY_END();
}
