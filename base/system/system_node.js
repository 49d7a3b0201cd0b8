// SPDX-License-Identifier: BSD-3-Clause
// What emscripten's own files lack in node, where conus reads and writes the user's files: a library of its linker, whose
// functions take the place of those of the same names. Each lies between a call of C and one of node's module fs.
mergeInto(LibraryManager.library, {
  $nodeSystem__deps: ["$FS", "$SYSCALLS", "$ENV", "$ERRNO_CODES", "$NODERAWFS"],
  $nodeSystem__postset: "nodeSystem.begin();",
  $nodeSystem: {
    // Errors of node as those of a system.
    named: (call) => function () {
      try {
        return call.apply(this, arguments);
      } catch (error) {
        if (error instanceof FS.ErrnoError || !error.code) throw error;
        throw new FS.ErrnoError(ERRNO_CODES[error.code] || {{{ cDefine('EIO') }}});
      }
    },
    // What a call of the system returns: below 0 = an error.
    answer: (call) => {
      try {
        return nodeSystem.named(call)() || 0;
      } catch (error) {
        if (!(error instanceof FS.ErrnoError)) throw error;
        return -error.errno;
      }
    },
    // Waits where a pipe or a terminal that others use, too, is not to be waited for.
    patiently: (call) => {
      for (;;) {
        try {
          return call();
        } catch (error) {
          if (error.code !== "EAGAIN") throw error;
          Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0, 5);
        }
      }
    },
    whole: (low, high) => high * 0x100000000 + (low >>> 0),

    files: {
      createStandardStreams: () => {
        for (const fd of [0, 1, 2]) {
          FS.streams[fd] = { fd, nfd: fd, position: 0, path: "", flags: fd ? 1 : 0, tty: require("tty").isatty(fd), seekable: false };
        }
      },
      open: (path, flags, mode, least) => {
        const known = [["O_WRONLY", 1], ["O_RDWR", 2], ["O_CREAT", 0o100], ["O_EXCL", 0o200], ["O_NOCTTY", 0o400], ["O_TRUNC", 0o1000], ["O_APPEND", 0o2000],
          ["O_NONBLOCK", 0o4000], ["O_DIRECTORY", 0o200000], ["O_NOFOLLOW", 0o400000], ["O_NOATIME", 0o1000000]];
        if (flags & 0o20000000) throw new FS.ErrnoError({{{ cDefine('EOPNOTSUPP') }}}); // O_TMPFILE: no name leads to the file later
        const how = known.reduce((sum, [name, bit]) => sum | (flags & bit ? fs.constants[name] || 0 : 0), 0);
        const nfd = fs.openSync(path, how, mode);
        const is = fs.fstatSync(nfd);
        const fd = FS.nextfd(Math.max(nfd, least || 0));
        const seekable = is.isFile() || is.isDirectory();
        // Of a device, to which writing is appending, the end is not looked for.
        return FS.streams[fd] = { fd, nfd, position: 0, path, flags: seekable ? flags : flags & ~0o2000, seekable,
          node: { id: is.ino, mode: is.mode, node_ops: NODERAWFS, path } };
      },
      llseek: (stream, offset, whence) => {
        if (!stream.stream_ops && !stream.seekable) throw new FS.ErrnoError({{{ cDefine('ESPIPE') }}});
        return NODERAWFS.llseek(stream, offset, whence);
      },
      read: (stream, buffer, offset, length, position) =>
        nodeSystem.patiently(() => NODERAWFS.read(stream, buffer, offset >>> 0, length, position)),
      write: (stream, buffer, offset, length, position) => { // all of it: what follows must not come before its rest
        for (let done = 0; done < length;) {
          done += nodeSystem.patiently(() => NODERAWFS.write(stream, buffer, (offset >>> 0) + done, length - done,
            position === undefined ? undefined : position + done));
        }
        return length;
      },
      // Of a folder only the names are asked for: no kinds, which a file that has just gone would not have.
      lookupNode: () => ({ id: 1, mode: 0 }),
      fchmod: (fd, mode) => fs.fchmodSync(SYSCALLS.getStreamFromFD(fd).nfd, mode & ~process.umask()), // C's umask() does not know it
    },

    begin: () => {
      requireNodeFS();
      for (const name in nodeSystem.files) {
        FS[name] = nodeSystem.named(nodeSystem.files[name]);
      }
      SYSCALLS.doAccess = nodeSystem.named((path, mode) => fs.accessSync(path, mode) || 0);
      SYSCALLS.doStat = nodeSystem.named((find, path, out) => { // times to the nanosecond, inodes of 64 bits
        const is = find(path, { bigint: true }), memory = new DataView(HEAP8.buffer, out >>> 0), second = BigInt(1e9);
        const put = (at, value) => memory.setInt32(at, Number(BigInt.asIntN(32, value)), true);
        const putTime = (at, ns) => {
          put(at, ns / second);
          put(at + 4, ns % second);
        };
        put({{{ C_STRUCTS.stat.st_dev }}}, is.dev);
        put({{{ C_STRUCTS.stat.st_mode }}}, is.mode);
        put({{{ C_STRUCTS.stat.st_nlink }}}, is.nlink);
        put({{{ C_STRUCTS.stat.st_uid }}}, is.uid);
        put({{{ C_STRUCTS.stat.st_gid }}}, is.gid);
        putTime({{{ C_STRUCTS.stat.st_atim.tv_sec }}}, is.atimeNs);
        putTime({{{ C_STRUCTS.stat.st_mtim.tv_sec }}}, is.mtimeNs);
        putTime({{{ C_STRUCTS.stat.st_ctim.tv_sec }}}, is.ctimeNs);
        memory.setBigInt64({{{ C_STRUCTS.stat.st_size }}}, is.size, true);
        memory.setBigInt64({{{ C_STRUCTS.stat.st_ino }}}, is.ino, true);
        return 0;
      });
      // The user's environment, byte for byte, and nothing that emscripten would add; "_" is where this program is.
      for (const name of ["USER", "LOGNAME", "PATH", "PWD", "HOME", "LANG"]) {
        ENV[name] = undefined;
      }
      for (const [name, value] of Object.entries(Object.assign({}, process.env, { _: __filename }))) {
        ENV[Buffer.from(name).toString("latin1")] = Buffer.from(value).toString("latin1");
      }
    },
  },

  __syscall_fstat64__deps: ["$nodeSystem"],
  __syscall_fstat64: function (fd, out) {
    return nodeSystem.answer(() => {
      const stream = SYSCALLS.getStreamFromFD(fd);
      return SYSCALLS.doStat(fs.fstatSync, stream.nfd, out);
    });
  },
  __syscall_ftruncate64__deps: ["$nodeSystem"],
  __syscall_ftruncate64: function (fd, low, high) {
    return nodeSystem.answer(() => fs.ftruncateSync(SYSCALLS.getStreamFromFD(fd).nfd, nodeSystem.whole(low, high)));
  },
  __syscall_linkat__deps: ["$nodeSystem"],
  __syscall_linkat: function (fromFolder, from, toFolder, to, flags) {
    return nodeSystem.answer(() =>
    fs.linkSync(SYSCALLS.calculateAt(fromFolder, UTF8ToString(from)), SYSCALLS.calculateAt(toFolder, UTF8ToString(to))));
  },
  __syscall_poll__deps: ["$nodeSystem"],
  __syscall_poll: function (wanted, count, timeout) { // reading from a file waits, so that it can be read at once
    let ready = 0;
    for (let at = wanted; at < wanted + count * {{{ C_STRUCTS.pollfd.__size__ }}}; at += {{{ C_STRUCTS.pollfd.__size__ }}}) {
      const stream = FS.getStream({{{ makeGetValue('at', C_STRUCTS.pollfd.fd, 'i32') }}});
      const is = !stream ? {{{ cDefine('POLLNVAL') }}} : stream.stream_ops ? stream.stream_ops.poll(stream) : SYSCALLS.DEFAULT_POLLMASK;
      const found = is & ({{{ makeGetValue('at', C_STRUCTS.pollfd.events, 'i16') }}} | {{{ cDefine('POLLNVAL') }}});
      {{{ makeSetValue('at', C_STRUCTS.pollfd.revents, 'found', 'i16') }}};
      ready += found ? 1 : 0;
    }
    return ready;
  },
  __syscall_ioctl__deps: ["$nodeSystem"],
  __syscall_ioctl: function (fd, what, more) {
    return nodeSystem.answer(() => {
      const stream = SYSCALLS.getStreamFromFD(fd);
      if (!stream.tty || what !== {{{ cDefine('TIOCGWINSZ') }}}) return -{{{ cDefine('ENOTTY') }}};
      const [columns, rows] = fd ? [process.stdout, process.stderr][fd - 1].getWindowSize() : [0, 0];
      HEAP32[HEAP32[more >> 2] >> 2] = rows | columns << 16;
    });
  },
  fd_pread__deps: ["$nodeSystem"],
  fd_pread: function (fd, vectors, count, low, high, out) {
    return -nodeSystem.answer(() => {
      const got = SYSCALLS.doReadv(SYSCALLS.getStreamFromFD(fd), vectors, count, nodeSystem.whole(low, high));
      HEAP32[out >> 2] = got;
    });
  },
  fd_pwrite__deps: ["$nodeSystem"],
  fd_pwrite: function (fd, vectors, count, low, high, out) {
    return -nodeSystem.answer(() => {
      const put = SYSCALLS.doWritev(SYSCALLS.getStreamFromFD(fd), vectors, count, nodeSystem.whole(low, high));
      HEAP32[out >> 2] = put;
    });
  },
  fd_sync__deps: ["$nodeSystem"],
  fd_sync: function (fd) {
    return -nodeSystem.answer(() => fs.fsyncSync(SYSCALLS.getStreamFromFD(fd).nfd));
  },
});
