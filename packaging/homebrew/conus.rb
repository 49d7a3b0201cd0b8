# For a tap of Homebrew, on macOS and Linux. The host and the sum of zeros are placeholders: scripts/release writes that of
# the source package into SHA256SUMS. Without the page of conus page. Never run by us: Debian has no brew.
class Conus < Formula
  desc "Which brain areas and fibre pathways are in that cone"
  homepage "https://conus.example.org"
  url "https://conus.example.org/releases/conus-0.1.0.tar.gz"
  sha256 "0000000000000000000000000000000000000000000000000000000000000000"
  license "BSD-3-Clause"

  depends_on "cmake" => :build
  depends_on "ninja" => :build
  depends_on "pkgconf" => :build
  depends_on "jansson"
  depends_on "libdeflate"
  depends_on "nettle"
  depends_on "zstd"

  uses_from_macos "expat"
  uses_from_macos "zlib"

  def install
    args = %w[MESH HDF5 VIEW PYTHON GL EMBREE TESTS BENCH].map { |part| "-DCONUS_#{part}=OFF" }
    system "cmake", "-S", ".", "-B", "build", "-G", "Ninja", *args, *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    system bin/"conus", "phantom", "sphere", "--size", "16", "-o", "."
    assert_match "Sphere", shell_output("#{bin}/conus query sphere.nii.gz --origin=0,0,90 --toward=0,0,0")
  end
end
