#include "harness/image_io.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <thread>

namespace abn::harness {
namespace {

namespace fs = std::filesystem;

class ImageIo : public ::testing::Test {
 protected:
  ImageIo() {
    std::string name = (fs::temp_directory_path() / "abn-image-io-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~ImageIo() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
    return names;
  }

  // Writes with OpenImageIO itself what save_image never writes.
  template <class T>
  std::string write(const std::string& name, const OIIO::ImageSpec& spec, const std::vector<T>& pixels) const {
    const auto output = OIIO::ImageOutput::create(path(name));
    EXPECT_TRUE(output && output->open(path(name), spec)) << name;
    const auto type = OIIO::BaseTypeFromC<T>::value;
    if (spec.tile_width > 0) {
      EXPECT_TRUE(
          output->write_tiles(spec.x, spec.x + spec.width, spec.y, spec.y + spec.height, 0, 1, type, pixels.data()));
    } else {
      EXPECT_TRUE(output->write_image(type, pixels.data())) << output->geterror();
    }
    EXPECT_TRUE(output->close());
    (void)output->geterror();
    return path(name);
  }

  fs::path folder_;
};

Image gradient(Extent size, std::uint32_t channels) {
  Image image(size, channels);
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    image.texels[i] = static_cast<float>(i + 1) / static_cast<float>(image.texels.size());
  }
  return image;
}

double srgb_decoded(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

std::string message_of(const std::string& path, const LoadOptions& options = {}) {
  try {
    (void)load_image(path, options);
  } catch (const IoError& error) {
    return error.what();
  }
  return "no error";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

TEST_F(ImageIo, FloatExrRoundTripsExactly) {
  for (const std::uint32_t channels : {1U, 3U}) {
    Image image = gradient({7, 5}, channels);
    image.texels[0] = -1e30F;
    image.texels[1] = 1e-30F;
    for (const char* name : {"a.exr", "a.tif"}) {
      save_image(path(name), image);
      const LoadedImage loaded = load_image(path(name));
      EXPECT_EQ(loaded.image.size, image.size);
      EXPECT_EQ(loaded.image.channels, channels);
      EXPECT_EQ(loaded.image.texels, image.texels) << name;
      EXPECT_TRUE(loaded.floating_point);
      EXPECT_TRUE(loaded.notices.empty());
    }
  }
}

TEST_F(ImageIo, HalfExrKeepsElevenBits) {
  const Image image = gradient({9, 9}, 3);
  save_image(path("h.exr"), image, {.depth = "half"});
  const LoadedImage loaded = load_image(path("h.exr"));
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    EXPECT_NEAR(loaded.image.texels[i], image.texels[i], image.texels[i] * 0x1p-11F);
  }
  Image bright = image;
  bright.texels[4] = 1e5F;
  EXPECT_THROW(save_image(path("bright.exr"), bright, {.depth = "half"}), IoError);
}

TEST_F(ImageIo, IntegersDecodeByTheExactSrgbCurve) {
  std::vector<std::uint8_t> bytes(256);
  for (std::size_t i = 0; i < 256; ++i) bytes[i] = static_cast<std::uint8_t>(i);
  const LoadedImage eight = load_image(write("g.png", OIIO::ImageSpec(256, 1, 1, OIIO::TypeDesc::UINT8), bytes));
  EXPECT_EQ(eight.image.channels, 1U);
  EXPECT_FALSE(eight.floating_point);
  for (std::size_t i = 0; i < 256; ++i) {
    EXPECT_FLOAT_EQ(eight.image.texels[i], static_cast<float>(srgb_decoded(static_cast<double>(i) / 255)));
  }
  std::vector<std::uint16_t> words(65536);
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = static_cast<std::uint16_t>(i);
  const LoadedImage sixteen = load_image(write("g16.png", OIIO::ImageSpec(256, 256, 1, OIIO::TypeDesc::UINT16), words));
  for (std::size_t i = 0; i < words.size(); i += 97) {
    EXPECT_FLOAT_EQ(sixteen.image.texels[i], static_cast<float>(srgb_decoded(static_cast<double>(i) / 65535)));
  }
}

TEST_F(ImageIo, IntegersThatAreSaidToBeLinearStayLinear) {
  OIIO::ImageSpec spec(2, 1, 1, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "Linear");
  const LoadedImage loaded = load_image(write("l.png", spec, std::vector<std::uint8_t>{51, 255}));
  EXPECT_FLOAT_EQ(loaded.image.texels[0], 0.2F);
  EXPECT_EQ(loaded.image.texels[1], 1.0F);
  EXPECT_EQ(loaded.notices.size(), 1U);
}

TEST_F(ImageIo, EveryByteSurvivesSavingAndLoading) {
  std::vector<std::uint8_t> bytes(256 * 3);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i / 3);
  save_rgb8(path("a.png"), {16, 16}, bytes);
  const LoadedImage once = load_image(path("a.png"));
  for (const char* name : {"b.png", "b.bmp", "b.tga"}) {
    save_image(path(name), once.image);
    EXPECT_EQ(load_image(path(name)).image.texels, once.image.texels) << name;
  }
  save_image(path("c.png"), once.image, {.depth = "uint16"});
  const LoadedImage deep = load_image(path("c.png"));
  for (std::size_t i = 0; i < bytes.size(); ++i) EXPECT_NEAR(deep.image.texels[i], once.image.texels[i], 3e-5);
}

TEST_F(ImageIo, ValuesOutsideTheUnitRangeAreClampedInIntegerFiles) {
  Image image({4, 1}, 1);
  image.texels = {-1.0F, 7.0F, std::numeric_limits<float>::quiet_NaN(), 1.0F};
  save_image(path("c.png"), image);
  EXPECT_EQ(load_image(path("c.png")).image.texels, (std::vector<float>{0, 1, 0, 1}));
}

TEST_F(ImageIo, JpegAndRgbeComeBackNearly) {
  Image image({32, 32}, 3);
  for (std::uint32_t y = 0; y < 32; ++y) {
    for (std::uint32_t x = 0; x < 32; ++x) {
      for (std::uint32_t c = 0; c < 3; ++c) image.texel(x, y)[c] = 0.2F + 0.01F * static_cast<float>(x);
    }
  }
  save_image(path("a.jpg"), image);
  save_image(path("a.hdr"), image);
  const Image jpeg = load_image(path("a.jpg")).image;
  const LoadedImage rgbe = load_image(path("a.hdr"));
  EXPECT_TRUE(rgbe.floating_point);
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    EXPECT_NEAR(jpeg.texels[i], image.texels[i], 0.02);
    EXPECT_NEAR(rgbe.image.texels[i], image.texels[i], 0.01 * image.texels[i]);
  }
  save_image(path("grey.hdr"), gradient({4, 4}, 1));
  EXPECT_EQ(load_image(path("grey.hdr")).image.channels, 3U);
}

TEST_F(ImageIo, ChannelsAreChosenByCountWithANotice) {
  struct Case {
    int stored;
    std::uint32_t kept;
    const char* notice;
  };
  for (const Case& c : {Case{1, 1, nullptr}, Case{2, 1, "the first one"}, Case{3, 3, nullptr}, Case{4, 3, "alpha"},
                        Case{5, 3, "the first three"}}) {
    OIIO::ImageSpec spec(3, 2, c.stored, OIIO::TypeDesc::FLOAT);
    if (c.stored == 2) spec.channelnames = {"left", "right"};
    if (c.stored == 5) spec.channelnames = {"R", "G", "B", "u", "v"};
    spec.alpha_channel = c.stored == 4 ? 3 : -1;
    std::vector<float> pixels(static_cast<std::size_t>(6 * c.stored));
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      pixels[i] = static_cast<float>(i % static_cast<std::size_t>(c.stored)) + 1;
    }
    const LoadedImage loaded = load_image(write(std::to_string(c.stored) + ".exr", spec, pixels));
    ASSERT_EQ(loaded.image.channels, c.kept) << c.stored;
    for (std::size_t i = 0; i < loaded.image.texels.size(); ++i) {
      EXPECT_EQ(loaded.image.texels[i], static_cast<float>(i % c.kept) + 1);
    }
    ASSERT_EQ(loaded.notices.size(), c.notice == nullptr ? 0U : 1U);
    if (c.notice != nullptr) {
      EXPECT_TRUE(contains(loaded.notices[0], c.notice)) << loaded.notices[0];
    }
  }
  const std::string five = path("5.exr");
  EXPECT_EQ(load_image(five, {.channels = "v"}).image.texels, std::vector<float>(6, 5.0F));
  const Image chosen = load_image(five, {.channels = "4,0,G"}).image;
  EXPECT_EQ((std::vector<float>(chosen.texels.begin(), chosen.texels.begin() + 3)), (std::vector<float>{5, 1, 2}));
  EXPECT_EQ(load_image(five, {.channels = "3,4,1"}).image.texels[2], 2.0F);
  for (const char* wrong : {"w", "5", "0,1", "0,1,2,3", "R,,B", ",", "-1", "99999999999"}) {
    EXPECT_THROW((void)load_image(five, {.channels = wrong}), ConfigError) << wrong;
  }
}

TEST_F(ImageIo, ColourUnderZeroAlphaIsKept) {
  const OIIO::ImageSpec spec(1, 1, 4, OIIO::TypeDesc::UINT8);
  const LoadedImage loaded = load_image(write("a.png", spec, std::vector<std::uint8_t>{255, 128, 0, 0}));
  EXPECT_EQ(loaded.image.texels[0], 1.0F);
  EXPECT_FLOAT_EQ(loaded.image.texels[1], static_cast<float>(srgb_decoded(128.0 / 255)));
}

TEST_F(ImageIo, TheDataWindowIsTheImage) {
  OIIO::ImageSpec spec(3, 2, 1, OIIO::TypeDesc::FLOAT);
  spec.x = -1;
  spec.y = 4;
  spec.full_width = 10;
  spec.full_height = 20;
  const LoadedImage loaded = load_image(write("w.exr", spec, std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(loaded.image.size, (Extent{3, 2}));
  EXPECT_EQ(loaded.image.texels, (std::vector<float>{1, 2, 3, 4, 5, 6}));
  ASSERT_EQ(loaded.notices.size(), 1U);
  EXPECT_TRUE(contains(loaded.notices[0], "data window"));
}

TEST_F(ImageIo, TiledFilesReadLikeOthers) {
  OIIO::ImageSpec spec(70, 50, 3, OIIO::TypeDesc::FLOAT);
  spec.tile_width = spec.tile_height = 16;
  const Image image = gradient({70, 50}, 3);
  EXPECT_EQ(load_image(write("t.exr", spec, image.texels)).image.texels, image.texels);
  EXPECT_EQ(load_image(write("t.tif", spec, image.texels)).image.texels, image.texels);
}

TEST_F(ImageIo, OfAMipmapTheFullLevelIsRead) {
  const Image image = gradient({40, 30}, 3);
  save_image(path("plain.exr"), image);
  ASSERT_TRUE(OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, path("plain.exr"), path("m.exr"),
                                               OIIO::ImageSpec()))
      << OIIO::geterror();
  const LoadedImage loaded = load_image(path("m.exr"));
  EXPECT_EQ(loaded.image.texels, image.texels);
  EXPECT_TRUE(loaded.notices.empty());
}

TEST_F(ImageIo, OrientationTagsAreApplied) {
  // The stored raster, by rows:  1 2 3 / 4 5 6. What each tag of EXIF means it to show:
  const std::vector<std::vector<float>> upright = {{1, 2, 3, 4, 5, 6}, {3, 2, 1, 6, 5, 4}, {6, 5, 4, 3, 2, 1},
                                                   {4, 5, 6, 1, 2, 3}, {1, 4, 2, 5, 3, 6}, {4, 1, 5, 2, 6, 3},
                                                   {6, 3, 5, 2, 4, 1}, {3, 6, 2, 5, 1, 4}};
  for (int tag = 1; tag <= 8; ++tag) {
    OIIO::ImageSpec spec(3, 2, 1, OIIO::TypeDesc::FLOAT);
    spec.attribute("Orientation", tag);
    const LoadedImage loaded = load_image(write("o.tif", spec, std::vector<float>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(loaded.image.size, tag < 5 ? (Extent{3, 2}) : (Extent{2, 3}));
    EXPECT_EQ(loaded.image.texels, upright[static_cast<std::size_t>(tag - 1)]) << tag;
    EXPECT_EQ(loaded.notices.size(), tag == 1 ? 0U : 1U);
  }
}

TEST_F(ImageIo, NonFiniteTexelsAreRefusedUnlessToldOtherwise) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  OIIO::ImageSpec spec(2, 2, 3, OIIO::TypeDesc::FLOAT);
  const std::string file = write("n.exr", spec, std::vector<float>{1, 2, 3, 4, 5, inf, -7, nan, 9, -inf, 11, -12});
  const std::string message = message_of(file);
  EXPECT_TRUE(contains(message, "3 values")) << message;
  EXPECT_TRUE(contains(message, "(1, 0) channel 2")) << message;
  EXPECT_TRUE(contains(message, "--on-nonfinite zero")) << message;
  EXPECT_EQ(load_image(file, {.on_nonfinite = OnNonfinite::zero}).image.texels,
            (std::vector<float>{1, 2, 3, 4, 5, 0, -7, 0, 9, 0, 11, -12}));
  const LoadedImage clamped = load_image(file, {.on_nonfinite = OnNonfinite::clamp});
  EXPECT_EQ(clamped.image.texels, (std::vector<float>{1, 2, 3, 4, 5, 9, -7, 0, 9, -7, 11, -12}));
  EXPECT_EQ(clamped.notices.size(), 1U);
  EXPECT_THROW(parse_on_nonfinite("ignore"), ConfigError);
}

TEST_F(ImageIo, WhatIsNoImageIsOneClearLine) {
  write_bytes(path("empty.png"), "");
  write_bytes(path("text.png"), "This is not an image.\n");
  write_bytes(path("text.txt"), "This is not an image.\n");
  fs::create_directory(path("folder.png"));
  for (const char* name : {"missing.png", "empty.png", "text.png", "text.txt", "folder.png", "no/such/folder.exr"}) {
    const std::string message = message_of(path(name));
    EXPECT_TRUE(contains(message, path(name))) << message;
    EXPECT_TRUE(contains(message, "; ")) << message;
    EXPECT_FALSE(contains(message, "\n")) << message;
  }
  EXPECT_TRUE(contains(message_of(path("missing.png")), "no such file"));
  EXPECT_TRUE(contains(message_of(path("empty.png")), "0 bytes"));
  EXPECT_TRUE(contains(message_of(path("folder.png")), "directory"));
}

TEST_F(ImageIo, SubsampledExrIsRefused) {
  OIIO::ImageSpec spec(8, 8, 3, OIIO::TypeDesc::HALF);
  spec.attribute("compression", "none");
  write("s.exr", spec, gradient({8, 8}, 3).texels);
  std::string bytes = bytes_of(path("s.exr"));
  // The channel list: name, 0, type, linear flag, 3 bytes reserved, x and y sampling; B comes first.
  const std::size_t list = bytes.find("chlist");
  ASSERT_NE(list, std::string::npos);
  const std::size_t x_sampling = list + 7 + 4 + 2 + 4 + 4;
  ASSERT_EQ(bytes[x_sampling], 1);
  bytes[x_sampling] = bytes[x_sampling + 4] = 2;
  write_bytes(path("s.exr"), bytes);
  const std::string message = message_of(path("s.exr"));
  EXPECT_TRUE(contains(message, "ubsampled")) << message;
}

TEST_F(ImageIo, AnImageLargerThanMemoryIsRefusedBeforeItIsAllocated) {
  save_image(path("big.hdr"), gradient({8, 8}, 3));
  std::string bytes = bytes_of(path("big.hdr"));
  const std::string size = "-Y 8 +X 8";
  const std::size_t at = bytes.find(size);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, size.size(), "-Y 500000 +X 500000");  // 2.7 TiB
  write_bytes(path("big.hdr"), bytes);
  const std::string message = message_of(path("big.hdr"));
  EXPECT_TRUE(contains(message, "GiB") || contains(message, "limit")) << message;
}

TEST_F(ImageIo, TruncatedFilesNeverGiveAPartialImage) {
  const Image image = gradient({64, 64}, 3);
  for (const std::string extension : {"png", "jpg", "exr", "tif", "hdr", "bmp"}) {
    save_image(path("whole." + extension), image);
    const std::string bytes = bytes_of(path("whole." + extension));
    const Image whole = load_image(path("whole." + extension)).image;
    for (std::size_t k = 0; k < 40; ++k) {
      const std::size_t length = k < 20 ? bytes.size() * k / 20 : bytes.size() - (k - 19);
      write_bytes(path("part." + extension), bytes.substr(0, length));
      try {
        // Bytes after the last pixel may be missing; then the image is the whole one.
        EXPECT_EQ(load_image(path("part." + extension)).image.texels, whole.texels) << extension << " " << length;
        EXPECT_GT(length, bytes.size() * 9 / 10) << extension;
      } catch (const IoError& error) {
        EXPECT_TRUE(contains(error.what(), "part." + extension));
      }
    }
  }
}

TEST_F(ImageIo, FlippedBitsGiveAnImageOrAnError) {
  const Image image = gradient({24, 24}, 3);
  for (const std::string extension : {"png", "jpg", "exr"}) {
    save_image(path("whole." + extension), image);
    const std::string bytes = bytes_of(path("whole." + extension));
    int refused = 0;
    for (std::size_t k = 0; k < 150; ++k) {
      std::string damaged = bytes;
      const std::size_t at = k * 7919 % bytes.size();
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << (k % 8)));
      write_bytes(path("bad." + extension), damaged);
      try {
        const LoadedImage loaded = load_image(path("bad." + extension));
        EXPECT_EQ(loaded.image.texels.size(), loaded.image.size.area() * loaded.image.channels);
      } catch (const IoError&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 0) << extension;
  }
}

TEST_F(ImageIo, EqualImagesAreEqualFiles) {
  const Image image = gradient({5, 5}, 3);
  const std::vector<std::string> names = {"a.exr", "a.png", "a.jpg", "a.tif", "a.hdr"};
  std::vector<std::string> before;
  for (const auto& name : names) {
    save_image(path(name), image);
    before.push_back(bytes_of(path(name)));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // dates in files have seconds
  for (std::size_t i = 0; i < names.size(); ++i) {
    save_image(path(names[i]), image);
    EXPECT_EQ(bytes_of(path(names[i])), before[i]) << names[i];
  }
}

TEST_F(ImageIo, UnknownExtensionsAndDepthsListWhatWorks) {
  const Image image = gradient({2, 2}, 1);
  for (const char* name : {"a.xyz", "a", "a.exr.part", ".png"}) {
    EXPECT_THROW(save_image(path(name), image), ConfigError) << name;
  }
  EXPECT_THROW(save_image(path("a.png"), image, {.depth = "float"}), ConfigError);
  EXPECT_THROW(save_image(path("a.exr"), image, {.depth = "uint8"}), ConfigError);
  EXPECT_THROW(save_rgb8(path("a.exr"), {1, 1}, std::vector<std::uint8_t>(3)), ConfigError);
  EXPECT_TRUE(files().empty());
  save_image(path("A.PNG"), image);
  EXPECT_TRUE(fs::exists(path("A.PNG")));
}

TEST_F(ImageIo, AFailedSaveLeavesNothingAndKeepsTheOldFile) {
  EXPECT_THROW(save_image(path("no/such/folder/a.exr"), gradient({2, 2}, 1)), IoError);
  EXPECT_TRUE(files().empty());

  save_image(path("a.exr"), gradient({2, 2}, 1));
  const std::string before = bytes_of(path("a.exr"));
  // A full disk: no file may grow beyond 4 KiB.
  Image noise({200, 200}, 3);
  std::uint32_t bits = 1;
  for (float& value : noise.texels) {
    bits = bits * 1664525U + 1013904223U;
    value = static_cast<float>(bits) * 0x1p-32F;
  }
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit small{4096, limit.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  for (const char* name : {"a.exr", "a.png", "a.jpg", "a.tif", "a.hdr", "a.bmp", "a.tga"}) {
    try {
      save_image(path(name), noise);
      ADD_FAILURE() << name << " was written";
    } catch (const IoError& error) {
      EXPECT_TRUE(contains(error.what(), path(name))) << error.what();
      EXPECT_FALSE(contains(error.what(), "\n")) << error.what();
    }
  }
  setrlimit(RLIMIT_FSIZE, &limit);
  EXPECT_EQ(files(), std::vector<std::string>{"a.exr"});
  EXPECT_EQ(bytes_of(path("a.exr")), before);
}

TEST(PixelHash, SeesValuesSizeAndChannels) {
  const Image image = gradient({4, 3}, 3);
  const std::string hash = pixel_hash(image);
  EXPECT_EQ(hash, pixel_hash(image));
  EXPECT_EQ(hash.size(), 16U);
  Image other = image;
  other.texels.back() = std::nextafter(other.texels.back(), 2.0F);
  EXPECT_NE(hash, pixel_hash(other));
  other = image;
  other.size = {3, 4};
  EXPECT_NE(hash, pixel_hash(other));
  other = image;
  other.size = {12, 3};
  other.channels = 1;
  EXPECT_NE(hash, pixel_hash(other));
  // The hash is stored in manifests: it must never change.
  Image fixed({1, 1}, 1);
  fixed.texels = {0.5F};
  EXPECT_EQ(pixel_hash(fixed), "5cd1ed60e4329446");
}

}  // namespace
}  // namespace abn::harness
