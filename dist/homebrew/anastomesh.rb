# Formula of the tap anastomesh/tap, which installs the program of the release. dist/recipes fills the marked places.
class Anastomesh < Formula
  desc "Tetrahedral volume meshes of vascular networks"
  homepage "https://github.com/anastomesh/anastomesh"
  version "@VERSION@"
  license any_of: ["MIT", "Apache-2.0"]

  on_macos do
    on_arm do
      url "@URL@/anastomesh-@VERSION@-aarch64-macos.tar.gz"
      sha256 "@SHA256 anastomesh-@VERSION@-aarch64-macos.tar.gz@"
    end
    on_intel do
      url "@URL@/anastomesh-@VERSION@-x86_64-macos.tar.gz"
      sha256 "@SHA256 anastomesh-@VERSION@-x86_64-macos.tar.gz@"
    end
  end

  on_linux do
    on_arm do
      url "@URL@/anastomesh-@VERSION@-aarch64-linux.tar.gz"
      sha256 "@SHA256 anastomesh-@VERSION@-aarch64-linux.tar.gz@"
    end
    on_intel do
      url "@URL@/anastomesh-@VERSION@-x86_64-linux.tar.gz"
      sha256 "@SHA256 anastomesh-@VERSION@-x86_64-linux.tar.gz@"
    end
  end

  def install
    bin.install "anastomesh"
    man1.install Dir["man/*.1"]
    bash_completion.install "completions/anastomesh.bash" => "anastomesh"
    zsh_completion.install "completions/anastomesh.zsh" => "_anastomesh"
    fish_completion.install "completions/anastomesh.fish"
  end

  test do
    system bin/"anastomesh", "generate", "--organ", "ellipsoid", "--terminals", "5", "--output", "tree.vtp"
    system bin/"anastomesh", "mesh", "tree.vtp", "--output", "tree.vtu"
    system bin/"anastomesh", "check", "tree.vtu"
  end
end
