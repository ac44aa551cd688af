// SPDX-License-Identifier: BSD-3-Clause
// Our decoder of block textures against OpenGL's, as a shader sees them: bit by bit.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "encode/block_compression.h"
#include "viewer/egl_context.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/gl_objects.h"

namespace lfm {
namespace {

constexpr int kSide = 256;  // texels

constexpr const char* kVertex = R"(#version 330 core
in vec2 corner;
void main() { gl_Position = vec4(corner, 0.0, 1.0); }
)";
constexpr const char* kFragment = R"(#version 330 core
uniform sampler2D blocks;
out vec4 color;
void main() { color = texelFetch(blocks, ivec2(gl_FragCoord.xy), 0); }
)";

std::vector<uint8_t> RandomBlocks(size_t bytes, int seed) {
  std::mt19937 random(seed);
  std::vector<uint8_t> blocks(bytes);
  for (uint8_t& byte : blocks) byte = static_cast<uint8_t>(random());
  return blocks;
}

// What texelFetch gives, as 8-bit RGB; row 0 of the texture is the bottom of the framebuffer.
Image FetchTexels(GLenum format, const std::vector<uint8_t>& blocks) {
  const GlObject texture(GlObject::Kind::kTexture);
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glCompressedTexImage2D(GL_TEXTURE_2D, 0, format, kSide, kSide, 0,
                         static_cast<GLsizei>(blocks.size()), blocks.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  CheckGl("upload blocks");
  const GlObject program = MakeProgram(kVertex, kFragment, {"corner"});
  const GlObject array(GlObject::Kind::kVertexArray), buffer(GlObject::Kind::kBuffer);
  glBindVertexArray(array.name());
  glBindBuffer(GL_ARRAY_BUFFER, buffer.name());
  const float corners[] = {-1, -1, 3, -1, -1, 3};
  glBufferData(GL_ARRAY_BUFFER, sizeof corners, corners, GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  const GlFramebuffer framebuffer(kSide, kSide, 1);
  framebuffer.Bind();
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_DITHER);
  glUseProgram(program.name());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glUniform1i(glGetUniformLocation(program.name(), "blocks"), 0);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  CheckGl("draw blocks");
  return framebuffer.Read();
}

class GlBlockTextures : public testing::Test {
 protected:
  EglContext context_;
};

TEST_F(GlBlockTextures, Bc1DecodesBitByBitAsOpenGl) {
  const std::vector<uint8_t> blocks = RandomBlocks(kSide * kSide / 2, 1);
  const Image expected = DecodePage({kSide, kSide, 1, blocks});
  const Image drawn = FetchTexels(GL_COMPRESSED_RGB_S3TC_DXT1_EXT, blocks);
  int differ = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      for (int c = 0; c < 3; ++c) {
        const int own = expected.At<uint8_t>(x, y, c);
        const int theirs = drawn.At<uint8_t>(x, kSide - 1 - y, c);
        differ += own != theirs;
        EXPECT_LE(std::abs(own - theirs), 0) << x << " " << y << " " << c;
        if (differ > 20) return;
      }
    }
  }
}

TEST_F(GlBlockTextures, Bc4AndBc5DecodeBitByBitAsOpenGl) {
  const std::vector<uint8_t> blocks = RandomBlocks(kSide * kSide / 2 * 3, 2);
  const Image expected = DecodePage({kSide, kSide, 3, blocks});
  const size_t plane = kSide * kSide / 2;
  std::vector<uint8_t> red(blocks.begin(), blocks.begin() + plane), both;
  for (size_t block = 0; block < plane; block += 8) {
    for (size_t c = 0; c < 2; ++c) {
      both.insert(both.end(), blocks.begin() + c * plane + block,
                  blocks.begin() + c * plane + block + 8);
    }
  }
  const Image one = FetchTexels(GL_COMPRESSED_RED_RGTC1, red);
  const Image two = FetchTexels(GL_COMPRESSED_RG_RGTC2, both);
  int differ = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      EXPECT_EQ(expected.At<uint8_t>(x, y, 0), one.At<uint8_t>(x, kSide - 1 - y, 0));
      for (int c = 0; c < 2; ++c) {
        differ += expected.At<uint8_t>(x, y, c) != two.At<uint8_t>(x, kSide - 1 - y, c);
        EXPECT_EQ(expected.At<uint8_t>(x, y, c), two.At<uint8_t>(x, kSide - 1 - y, c));
      }
      if (differ > 20) return;
    }
  }
}

}  // namespace
}  // namespace lfm
