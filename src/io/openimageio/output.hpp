// SPDX-License-Identifier: Apache-2.0
// The file that a picture is written to. Errors are noticed whichever library writes it, and nothing half-written
// appears under the final name.
#ifndef TETCAST_OPENIMAGEIO_OUTPUT_HPP
#define TETCAST_OPENIMAGEIO_OUTPUT_HPP

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <string>

#include <OpenImageIO/filesystem.h>

namespace tetcast {

// A file that will be named `path` (symbolic links followed, also to where there is nothing yet) once it is complete.
// It keeps the mode of the file that it replaces. Until then it is a hidden file beside it with the same extension,
// which goes away with the object, and which a lock (flock) tells from those that killed processes have left.
class NewFile {
public:
  NewFile() = default;
  ~NewFile();
  NewFile(const NewFile &) = delete;
  NewFile &operator=(const NewFile &) = delete;

  // All return 0 or an errno value.
  int open(const std::string &path);
  int publish();

  const std::string &temporary() const { return m_temporary; }
  std::FILE *file() const { return m_file; }

private:
  std::string m_target, m_temporary;
  std::FILE *m_file = nullptr;
  int m_lock = -1; // the same file's descriptor once more, which holds the lock until the file has its name
};

// What OpenImageIO's formats write through. It always claims success, as several of the libraries below answer a failed
// write by printing or not at all, and remembers the first error instead.
class CheckedProxy : public OIIO::Filesystem::IOProxy {
public:
  CheckedProxy(std::FILE *file, const std::string &name) : IOProxy(name, Write), m_file(file) {}

  int error_number() const { return m_errno; }

  const char *proxytype() const override { return "checked"; } // "file" would be taken for OpenImageIO's own class
  void close() override {}
  int64_t tell() override { return m_pos; }
  bool seek(int64_t offset) override;
  size_t read(void *data, size_t size) override;
  size_t write(const void *data, size_t size) override;
  size_t pread(void *data, size_t size, int64_t offset) override;
  size_t pwrite(const void *data, size_t size, int64_t offset) override;
  size_t size() const override { return m_size; }
  void flush() const override {}

private:
  void fail() { m_errno = m_errno ? m_errno : (errno ? errno : EIO); }

  std::FILE *m_file;
  size_t m_size = 0;
  int64_t m_file_position = 0; // of m_file: spares a seek, which empties the buffer, before each write
  int m_errno = 0;
};

} // namespace tetcast

#endif
