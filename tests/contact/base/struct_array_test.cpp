// Arrays of structs in packs (contact/base/struct_array.hpp), with packs of one and of many.
#include "contact/base/struct_array.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace brickwall {

struct Record {
  double value = -1;
  int number = -1;
  bool flag = false, other_flag = true;
  double pair[2] = {-1, -1};
};

std::vector<Record> someRecords(int count) {
  std::vector<Record> records(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Record& record = records[static_cast<std::size_t>(i)];
    record.value = 0.5 * i;
    record.number = i;
    record.flag = i % 3 == 0;
    record.other_flag = i % 2 == 0;
    record.pair[0] = -i;
    record.pair[1] = 1.0 / (i + 1);
  }
  return records;
}

// Changes each member in another way of writing: one alone, all by store(), and some by edit().
template <class Array>
void change(const Array& array, int count) {
  Kokkos::parallel_for(
      "test::change", rangePolicy(exec_space(), count), KOKKOS_LAMBDA(const std::int64_t i) {
        array.setMember(i, &Record::value, array(i).value + 1);
        Record record = array(i);
        record.number *= 2;
        record.other_flag = !record.other_flag;
        array.store(i, record);
        Record local = array(i);
        Record& edited = array.edit(i, local);
        edited.pair[1] = edited.pair[0] - 1;
        array.commit(i, edited);
      });
}

template <class Array>
void expectChanged(int count) {
  const std::vector<Record> before = someRecords(count);
  Array array("test::records", count);
  EXPECT_GE(array.size(), count);
  array.assign(before);
  change(array, count);
  const auto after = toHost(array);
  for (int i = 0; i < count; ++i) {
    const Record &old = before[static_cast<std::size_t>(i)], &now = after(i);
    EXPECT_EQ(now.value, old.value + 1) << i;
    EXPECT_EQ(now.number, 2 * old.number) << i;
    EXPECT_EQ(now.flag, old.flag) << i;
    EXPECT_EQ(now.other_flag, !old.other_flag) << i;
    EXPECT_EQ(now.pair[0], old.pair[0]) << i;
    EXPECT_EQ(now.pair[1], old.pair[0] - 1) << i;
  }
}

TEST(StructArray, ReadsWritesAndChangesMembersInPacksOfAnySize) {
  for (const int count : {1, 31, 32, 33, 1000}) {
    if constexpr (host_accessible) // a pack of one is a reference to the struct
      expectChanged<StructArray<Record, 1>>(count);
    expectChanged<StructArray<Record, 32>>(count);
    expectChanged<StructArray<Record>>(count);
  }
}

TEST(StructArray, GrowsToHoldWhatItIsAskedFor) {
  StructArray<Record, 32> array("test::records");
  EXPECT_EQ(array.size(), 0);
  growTo(exec_space(), array, 33);
  EXPECT_GE(array.size(), 33);
  const std::int64_t size = array.size();
  growTo(exec_space(), array, 20);
  EXPECT_EQ(array.size(), size);
}

} // namespace brickwall
