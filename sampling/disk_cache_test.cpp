#include "sampling/disk_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "sampling/rng.h"
#include "sampling/test_folder.h"

namespace abn {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

Bytes some_bytes(std::size_t count, std::uint64_t seed = 1) {
  Bytes bytes(count);
  Rng rng(seed, stream_id("disk_cache test"));
  for (std::byte& b : bytes) b = static_cast<std::byte>(rng.next() & 255U);
  return bytes;
}

fs::path only_file(const fs::path& folder) {
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
  return fs::directory_iterator(folder)->path();
}

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void overwrite(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

/// An environment variable for the time of a test.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name); old != nullptr) old_ = old;
    set(value);
  }
  ~Environment() { set(old_ ? old_->c_str() : nullptr); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  void set(const char* value) const {
    if (value == nullptr) {
      ::unsetenv(name_);
    } else {
      ::setenv(name_, value, 1);
    }
  }
  const char* name_;
  std::optional<std::string> old_;
};

TEST(DiskCache, GivesBackWhatWasStored) {
  const TestFolder folder;
  const DiskCache cache(folder.path() / "a" / "b");
  EXPECT_FALSE(cache.load("key"));
  EXPECT_FALSE(fs::exists(folder.path() / "a"));  // a load creates nothing
  for (const std::size_t count : {0, 1, 7, 8, 9, 100'000}) {
    const Bytes bytes = some_bytes(count, count);
    const std::string key = "key " + std::to_string(count);
    cache.store(key, bytes);
    EXPECT_EQ(cache.load(key), bytes);
  }
  EXPECT_EQ(cache.status().files, 6U);
  EXPECT_GT(cache.status().bytes, 100'000U);
  EXPECT_TRUE(cache.status().writable);
  EXPECT_EQ(fs::status(cache.folder()).permissions(), fs::perms::owner_all);
}

TEST(DiskCache, KeysAreKeptApart) {
  const TestFolder folder;
  const DiskCache cache(folder.path());
  const std::string keys[] = {"", "plane 200x200", "plane 200x201", std::string("zero\0a", 6),
                              std::string("zero\0b", 6)};
  for (std::size_t i = 0; i < std::size(keys); ++i) cache.store(keys[i], some_bytes(50, i));
  for (std::size_t i = 0; i < std::size(keys); ++i) EXPECT_EQ(cache.load(keys[i]), some_bytes(50, i)) << keys[i];
  EXPECT_FALSE(cache.load("plane 200x202"));
  cache.store(keys[1], some_bytes(9, 77));  // replaced
  EXPECT_EQ(cache.load(keys[1]), some_bytes(9, 77));
  EXPECT_EQ(folder.entries(), 5);
}

// The name of a file is only a hash: another key's bytes under it must not be believed.
TEST(DiskCache, FileOfAnotherKeyIsAMiss) {
  const TestFolder folder;
  const DiskCache cache(folder.path() / "cache");
  cache.store("one", some_bytes(50));
  const fs::path one = only_file(cache.folder());
  fs::rename(one, folder.path() / "kept");
  cache.store("two", some_bytes(50));
  fs::rename(only_file(cache.folder()), one);
  EXPECT_FALSE(cache.load("one"));
  fs::rename(folder.path() / "kept", one);
  EXPECT_TRUE(cache.load("one"));
}

TEST(DiskCache, EveryDamageIsAMissAndIsRepaired) {
  const TestFolder folder;
  const DiskCache cache(folder.path());
  const Bytes bytes = some_bytes(61);
  cache.store("key", bytes);
  const fs::path file = only_file(folder.path());
  const std::string good = content(file);
  for (std::size_t length = 0; length < good.size(); ++length) {
    overwrite(file, good.substr(0, length));
    ASSERT_FALSE(cache.load("key")) << length;
  }
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 16);
    overwrite(file, bad);
    ASSERT_FALSE(cache.load("key")) << at;
  }
  overwrite(file, good + "x");
  EXPECT_FALSE(cache.load("key"));
  overwrite(file, std::string(5000, '\xFF'));  // lengths beyond all memory
  EXPECT_FALSE(cache.load("key"));
  cache.store("key", bytes);
  EXPECT_EQ(cache.load("key"), bytes);
}

TEST(DiskCache, FolderOrPipeInTheFilesPlaceIsAMiss) {
  const TestFolder folder;
  const DiskCache cache(folder.path());
  cache.store("key", some_bytes(10));
  const fs::path file = only_file(folder.path());
  fs::remove(file);
  fs::create_directory(file);
  EXPECT_FALSE(cache.load("key"));
  cache.store("key", some_bytes(10));
  fs::remove(file);
  ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
  EXPECT_FALSE(cache.load("key"));  // and does not wait for a writer
}

TEST(DiskCache, UnusableFolderIsNoError) {
  const TestFolder folder;
  overwrite(folder.path() / "file", "");
  for (const fs::path& unusable : {fs::path{}, folder.path() / "file", folder.path() / "file" / "cache"}) {
    const DiskCache cache(unusable);
    EXPECT_NO_THROW(cache.store("key", some_bytes(10)));
    EXPECT_FALSE(cache.load("key"));
    EXPECT_FALSE(cache.status().writable);
  }
}

TEST(DiskCache, ReadOnlyFolderStillServes) {
  if (::geteuid() == 0) GTEST_SKIP() << "the superuser may write everywhere";
  const TestFolder folder;
  const DiskCache cache(folder.path() / "cache");
  cache.store("old", some_bytes(10));
  fs::permissions(cache.folder(), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_NO_THROW(cache.store("new", some_bytes(10)));
  EXPECT_FALSE(cache.load("new"));
  EXPECT_TRUE(cache.load("old"));
  EXPECT_FALSE(cache.status().writable);
  fs::permissions(cache.folder(), fs::perms::owner_all);
}

TEST(DiskCache, UnusedForLongestGoFirst) {
  const TestFolder folder;
  const DiskCache cache(folder.path(), 3500);
  const auto now = fs::file_time_type::clock::now();
  const std::string keys[] = {"a", "b", "c"};
  for (int i = 0; i < 3; ++i) {
    cache.store(keys[i], some_bytes(1000));
    for (const auto& entry : fs::directory_iterator(folder.path())) {
      // Older the earlier it was stored.
      if (now - entry.last_write_time() < std::chrono::minutes(1)) {
        fs::last_write_time(entry.path(), now - std::chrono::hours(10 - i));
      }
    }
  }
  overwrite(folder.path() / "notes.txt", std::string(9000, '.'));  // not ours: neither counted nor deleted
  ASSERT_TRUE(cache.load("a"));                                    // now the youngest
  cache.store("d", some_bytes(1000));
  EXPECT_TRUE(cache.load("a"));
  EXPECT_FALSE(cache.load("b"));
  EXPECT_TRUE(cache.load("c"));
  EXPECT_TRUE(cache.load("d"));
  cache.store("too large", some_bytes(4000));
  EXPECT_FALSE(cache.load("too large"));
  EXPECT_EQ(cache.status().files, 3U);
  EXPECT_LE(cache.status().bytes, 3500U);
  EXPECT_TRUE(fs::exists(folder.path() / "notes.txt"));
}

TEST(DiskCache, ConcurrentWritersAndReadersSeeWholeEntries) {
  const TestFolder folder;
  std::vector<std::thread> threads;
  for (std::uint64_t t = 0; t < 4; ++t) {
    threads.emplace_back([&folder, t] {
      const DiskCache cache(folder.path(), 30'000);
      for (std::uint64_t i = 0; i < 20; ++i) {
        cache.store("key", some_bytes(4000 + t, t));
        cache.store("key " + std::to_string(i), some_bytes(4000, i));
        if (const auto bytes = cache.load("key")) {
          EXPECT_EQ(*bytes, some_bytes(bytes->size(), bytes->size() - 4000));
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_LE(DiskCache(folder.path()).status().bytes, 30'000U);
}

TEST(DiskCache, LiesWhereTheEnvironmentSays) {
  const TestFolder folder;
  const Environment home("HOME", folder.path().c_str());
  {
    const Environment cache("XDG_CACHE_HOME", nullptr);
    EXPECT_EQ(cache_folder(), folder.path() / ".cache" / "abn");
  }
  {
    const Environment cache("XDG_CACHE_HOME", "relative");
    EXPECT_EQ(cache_folder(), folder.path() / ".cache" / "abn");
  }
  {
    const Environment cache("XDG_CACHE_HOME", nullptr);
    const Environment nobody("HOME", nullptr);
    EXPECT_TRUE(cache_folder().empty());
    store_cached("key", some_bytes(10));
    EXPECT_FALSE(load_cached("key"));
  }
  const fs::path base = folder.path() / "x";
  const Environment cache("XDG_CACHE_HOME", base.c_str());
  EXPECT_EQ(cache_folder(), base / "abn");
  const std::vector<float> values = {1, 2.5F, -3};
  store_cached_values<float>("values", values);
  EXPECT_EQ(load_cached_values<float>("values"), values);
  EXPECT_FALSE(load_cached_values<double>("values"));  // 12 bytes are no doubles
  EXPECT_TRUE(fs::exists(base / "abn"));
}

}  // namespace
}  // namespace abn
