// SPDX-License-Identifier: LGPL-2.1-or-later
// Which thread delivers the items of others, in which order, and what stays of them.
#include "threads/in_order.h"

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"

namespace {

using cerberus::threads::InOrder;
using Numbers = std::vector<int>;

void put_all(InOrder<int, 4>& order, const Numbers& numbers) {
  for (const int number : numbers) order.put(number);
}

// All items that are delivered now.
template <typename Order>
Numbers delivered(Order& order) {
  Numbers all;
  order.deliver([&](int number) { all.push_back(number); });
  return all;
}

START_TEST(the_first_item_is_delivered_first_and_once) {
  InOrder<int, 4> order;
  for (int k = 0; k < 10; ++k) {  // and so it is when the places begin anew
    put_all(order, {3 * k, 3 * k + 1, 3 * k + 2});
    ck_assert((delivered(order) == Numbers{3 * k, 3 * k + 1, 3 * k + 2}));
  }
  ck_assert(delivered(order).empty());
}
END_TEST

START_TEST(an_item_put_in_by_a_listener_is_delivered_next) {
  InOrder<int, 4> order;
  Numbers all;
  const std::function<void(int)> listener = [&](int number) {
    all.push_back(number);
    if (number > 3) return;
    order.put(number + 10);
    order.deliver(listener);  // a delivery is in progress: nothing is delivered within it
    ck_assert_int_eq(all.back(), number);
  };
  put_all(order, {1, 2});
  order.deliver(listener);
  ck_assert((all == Numbers{1, 2, 11, 12}));
}
END_TEST

START_TEST(a_thread_blocked_by_a_listener_delivers_for_the_others_too) {
  InOrder<int, 4> order;
  std::promise<void> kept, go;
  Numbers all;
  order.put(1);
  std::thread teller([&] {
    order.deliver([&](int number) {
      all.push_back(number);
      if (number > 1) return;
      kept.set_value();
      go.get_future().wait();
    });
  });
  kept.get_future().wait();
  order.put(2);
  ck_assert(delivered(order).empty());  // and no item waits
  go.set_value();
  teller.join();
  ck_assert((all == Numbers{1, 2}));
}
END_TEST

START_TEST(of_more_items_than_can_wait_the_oldest_are_never_delivered) {
  InOrder<int, 4> order;
  put_all(order, {1, 2, 3, 4, 5, 6});
  ck_assert((delivered(order) == Numbers{3, 4, 5, 6}));
  put_all(order, {7});
  ck_assert((delivered(order) == Numbers{7}));
}
END_TEST

// A thread that delivers one item and is kept inside until go().
struct Delivery {
  InOrder<int, 4> order;
  std::promise<void> kept, released;
  bool over = false;
  std::thread thread;
  Delivery() {
    order.put(1);
    thread = std::thread([this] {
      order.deliver([this](int) {
        kept.set_value();
        released.get_future().wait();
        over = true;
      });
    });
    kept.get_future().wait();
  }
  ~Delivery() { thread.join(); }
  void go() { released.set_value(); }
};

START_TEST(a_thread_that_waits_goes_on_when_another_one_has_delivered) {
  Delivery delivery;
  delivery.go();
  delivery.order.wait(std::chrono::hours(1));
  ck_assert(delivery.over);
}
END_TEST

START_TEST(a_wait_ends_at_its_limit) {
  Delivery delivery;
  delivery.order.wait(std::chrono::milliseconds(1));
  ck_assert(!delivery.over);
  delivery.go();
}
END_TEST

START_TEST(a_listener_does_not_wait_for_itself) {
  InOrder<int, 4> order;
  order.put(1);
  int listened = 0;
  order.deliver([&](int) {
    order.wait(std::chrono::hours(1));
    ++listened;
  });
  ck_assert_int_eq(listened, 1);
  order.wait(std::chrono::hours(1));  // nothing is being delivered
}
END_TEST

// Ones replace ones, tens tens.
constexpr auto kSameKind = [](const int& a, const int& b) { return (a < 10) == (b < 10); };

START_TEST(of_more_items_than_can_wait_rare_ones_stay) {
  InOrder<int, 4> order(kSameKind);
  put_all(order, {10, 1, 2, 3, 4, 5});
  ck_assert((delivered(order) == Numbers{10, 3, 4, 5}));
  put_all(order, {1, 10, 2, 3, 20, 4, 5});  // also where the places begin anew, and in the middle
  ck_assert((delivered(order) == Numbers{3, 20, 4, 5}));
  put_all(order, {1, 10, 2, 3, 4});
  ck_assert((delivered(order) == Numbers{10, 2, 3, 4}));
  put_all(order, {10, 1, 2, 3, 20});  // the oldest that is replaced, by whomever
  ck_assert((delivered(order) == Numbers{1, 2, 3, 20}));
}
END_TEST

START_TEST(where_none_is_replaced_the_oldest_goes) {
  InOrder<int, 4> order([](const int& a, const int& b) { return a == b; });
  put_all(order, {1, 2, 3, 4, 5, 6});
  ck_assert((delivered(order) == Numbers{3, 4, 5, 6}));
  put_all(order, {1, 2, 3, 4, 3, 5});
  ck_assert((delivered(order) == Numbers{2, 4, 3, 5}));
}
END_TEST

START_TEST(cleared_items_are_not_delivered) {
  InOrder<int, 4> order;
  put_all(order, {1, 2, 3});
  order.clear();
  ck_assert(delivered(order).empty());
  put_all(order, {4, 5, 6, 7});
  Numbers all;
  order.deliver([&](int number) {  // nor by the delivery in progress
    all.push_back(number);
    if (number == 5) order.clear();
  });
  ck_assert((all == Numbers{4, 5}));
  put_all(order, {8});
  ck_assert((delivered(order) == Numbers{8}));
}
END_TEST

START_TEST(after_a_listener_that_throws_the_next_one_receives_the_rest) {
  InOrder<int, 4> order;
  put_all(order, {1, 2});
  bool thrown = false;
  try {
    order.deliver([](int) { throw std::runtime_error("no"); });
  } catch (const std::runtime_error&) {
    thrown = true;
  }
  ck_assert(thrown);
  ck_assert((delivered(order) == Numbers{2}));
}
END_TEST

START_TEST(nothing_is_kept_of_delivered_or_dropped_items) {
  InOrder<std::shared_ptr<int>, 2> order;
  const auto mine = std::make_shared<int>(1);
  order.put(mine);
  order.deliver([](const auto&) {});
  ck_assert_int_eq(mine.use_count(), 1);
  for (int k = 0; k < 5; ++k) order.put(mine);
  ck_assert_int_eq(mine.use_count(), 3);
  order.clear();
  ck_assert_int_eq(mine.use_count(), 1);
}
END_TEST

// Four threads put in a thousand numbers each and deliver after each of them; one at a time delivers.
START_TEST(of_each_thread_the_numbers_come_in_its_order) {
  constexpr int kThreads = 4, kEach = 1000;
  InOrder<int, kThreads * kEach> order;
  std::atomic<int> telling = 0;
  Numbers all;
  std::vector<std::thread> threads;
  for (int who = 0; who < kThreads; ++who)
    threads.emplace_back([&, who] {
      for (int k = 0; k < kEach; ++k) {
        order.put(who * kEach + k);
        order.deliver([&](int number) {
          ck_assert_int_eq(telling.fetch_add(1), 0);
          all.push_back(number);
          telling.fetch_sub(1);
        });
      }
    });
  for (std::thread& thread : threads) thread.join();
  ck_assert_int_eq(all.size(), kThreads * kEach);
  Numbers next(kThreads);
  for (const int number : all) ck_assert_int_eq(number % kEach, next[number / kEach]++);
}
END_TEST

START_TEST(nothing_is_allocated) {
  InOrder<int, 4> order;
  int sum = 0;
  const auto before = cerberus::tests::allocations();
  for (int k = 0; k < 1000; ++k) {
    order.put(k);
    if (k % 7 == 0) order.deliver([&](int number) { sum += number; });
  }
  ck_assert_uint_eq(cerberus::tests::allocations() - before, 0);
  ck_assert_int_gt(sum, 0);
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "in_order",
      {the_first_item_is_delivered_first_and_once, an_item_put_in_by_a_listener_is_delivered_next,
       a_thread_blocked_by_a_listener_delivers_for_the_others_too,
       of_more_items_than_can_wait_the_oldest_are_never_delivered, of_more_items_than_can_wait_rare_ones_stay,
       where_none_is_replaced_the_oldest_goes, cleared_items_are_not_delivered,
       after_a_listener_that_throws_the_next_one_receives_the_rest,
       nothing_is_kept_of_delivered_or_dropped_items, of_each_thread_the_numbers_come_in_its_order,
       a_thread_that_waits_goes_on_when_another_one_has_delivered, a_wait_ends_at_its_limit,
       a_listener_does_not_wait_for_itself, nothing_is_allocated});
}
