// Part of a message.
#pragma once

#include <gtest/gtest.h>

#include <string>

#define EXPECT_CONTAINS(message, part)                                                             \
  EXPECT_NE((message).find(part), std::string::npos) << "in:\n" << (message)
