//! The library of Open Image Denoise, of its version 2, loaded at run time, and the few functions of it that lumbre calls. Beside `src/gpu`
//! the only place with `unsafe`: calling C needs it, and the crates that wrap this library link it when lumbre is built.

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr;

use crate::error::{Error, Result};

/// The file that the system's loader looks for, where it looks for libraries and in `LD_LIBRARY_PATH`.
const FILE: &str = "libOpenImageDenoise.so.2";
/// `OIDN_DEVICE_TYPE_DEFAULT`: the fastest there is.
const DEFAULT_DEVICE: c_int = 0;
/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;

/// What the library hands out: devices, filters, buffers.
type Object = *mut c_void;

/// Declares the functions that are called, and finds all of them in the library.
macro_rules! functions {
    ($($name:ident = $symbol:literal ($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions of the library.
        struct Functions {
            $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Functions {
            fn find(library: &libloading::Library) -> Result<Self, libloading::Error> {
                // SAFETY: the types are those that oidn.h of version 2 declares, which the library's name promises.
                unsafe { Ok(Self { $($name: *library.get($symbol)?,)* }) }
            }
        }
    };
}

functions! {
    new_device = b"oidnNewDevice"(c_int) -> Object;
    commit_device = b"oidnCommitDevice"(Object);
    device_int = b"oidnGetDeviceInt"(Object, *const c_char) -> c_int;
    device_error = b"oidnGetDeviceError"(Object, *mut *const c_char) -> c_int;
    release_device = b"oidnReleaseDevice"(Object);
    new_buffer = b"oidnNewBuffer"(Object, usize) -> Object;
    write_buffer = b"oidnWriteBuffer"(Object, usize, usize, *const c_void);
    read_buffer = b"oidnReadBuffer"(Object, usize, usize, *mut c_void);
    release_buffer = b"oidnReleaseBuffer"(Object);
    new_filter = b"oidnNewFilter"(Object, *const c_char) -> Object;
    set_image = b"oidnSetFilterImage"(Object, *const c_char, Object, c_int, usize, usize, usize, usize, usize);
    set_bool = b"oidnSetFilterBool"(Object, *const c_char, bool);
    commit_filter = b"oidnCommitFilter"(Object);
    execute_filter = b"oidnExecuteFilter"(Object);
    release_filter = b"oidnReleaseFilter"(Object);
}

/// The library.
pub(super) struct Library {
    functions: Functions,
}

impl Library {
    /// Looks for it. Fails, saying what to install, where there is none.
    pub fn load() -> Result<Self> {
        let missing = |error: libloading::Error| {
            Error::Denoise(format!(
                "there is no {FILE}: {error}. Install version 2 from www.openimagedenoise.org or your system's packages (Python's pyoidn \
                 brings it too), and where it is not among the system's libraries set LD_LIBRARY_PATH to its folder"
            ))
        };
        // SAFETY: loading it runs its initialisers, which have no precondition.
        let library = unsafe { libloading::Library::new(FILE) }.map_err(missing)?;
        let functions = Functions::find(&library).map_err(missing)?;
        // It is never unloaded: its threads may run as long as the process does, and the functions are part of it.
        std::mem::forget(library);
        Ok(Self { functions })
    }
}

/// What runs filters: a GPU or the processor.
pub(super) struct Device {
    library: Library,
    object: Object,
}

impl Device {
    /// Sets the fastest one up.
    pub fn new(library: Library) -> Result<Self> {
        // SAFETY: the call has no precondition.
        let object = unsafe { (library.functions.new_device)(DEFAULT_DEVICE) };
        let device = Self { library, object };
        device.check("find a device")?;
        // SAFETY: the device is there.
        unsafe { (device.library.functions.commit_device)(object) };
        device.check("set its device up")?;
        Ok(device)
    }

    /// Fails with the last error of the device, if there was one since it was asked.
    fn check(&self, doing: &str) -> Result<()> {
        let mut message = ptr::null();
        // SAFETY: a null device asks for the error of having none; the message is a string that stays until the next error.
        let message = unsafe {
            let code = (self.library.functions.device_error)(self.object, &raw mut message);
            if code == 0 {
                return Ok(());
            }
            if message.is_null() {
                format!("error {code}")
            } else {
                CStr::from_ptr(message).to_string_lossy().into_owned()
            }
        };
        Err(Error::Denoise(format!("cannot {doing}: {message}")))
    }

    /// "2.3.1".
    pub fn version(&self) -> String {
        let part = |name: &CStr| {
            // SAFETY: the device is there, and the name ends with a zero.
            unsafe { (self.library.functions.device_int)(self.object, name.as_ptr()) }
        };
        format!("{}.{}.{}", part(c"versionMajor"), part(c"versionMinor"), part(c"versionPatch"))
    }

    /// Runs the filter for ray-traced images of high dynamic range over images of one size, each by its name; the result.
    pub fn ray_tracing_filter(
        &self,
        (width, height): (usize, usize),
        inputs: &[(&str, &[[f32; 3]])],
    ) -> Result<Vec<[f32; 3]>> {
        let functions = &self.library.functions;
        // SAFETY: the device is there, and the name ends with a zero.
        let filter = unsafe { (functions.new_filter)(self.object, c"RT".as_ptr()) };
        let filter = Owned { object: filter, release: functions.release_filter };
        self.check("make a filter")?;
        let set = |name: &str, buffer: &Owned| -> Result<()> {
            let name = CString::new(name).map_err(|error| Error::Denoise(error.to_string()))?;
            // SAFETY: filter and buffer are there, and the buffer has three numbers for each pixel.
            unsafe {
                (functions.set_image)(filter.object, name.as_ptr(), buffer.object, FLOAT3, width, height, 0, 0, 0)
            };
            self.check("set an image")
        };
        let mut buffers = Vec::new();
        for (name, pixels) in inputs {
            if pixels.len() != width * height {
                return Err(Error::Denoise(format!(
                    "{name} has {} pixels, and the image {}",
                    pixels.len(),
                    width * height
                )));
            }
            let buffer = self.buffer(size_of_val(*pixels))?;
            // SAFETY: the buffer is as large as the pixels that are copied to it.
            unsafe { (functions.write_buffer)(buffer.object, 0, size_of_val(*pixels), pixels.as_ptr().cast()) };
            self.check("copy an image")?;
            set(name, &buffer)?;
            buffers.push(buffer);
        }
        let mut result = vec![[0.0; 3]; width * height];
        let bytes = size_of_val(&result[..]);
        let output = self.buffer(bytes)?;
        set("output", &output)?;
        // SAFETY: all that the filter needs is there, and the result is as large as the buffer that is copied to it.
        unsafe {
            (functions.set_bool)(filter.object, c"hdr".as_ptr(), true);
            (functions.commit_filter)(filter.object);
            (functions.execute_filter)(filter.object);
            self.check("denoise")?;
            (functions.read_buffer)(output.object, 0, bytes, result.as_mut_ptr().cast());
        }
        self.check("read the result")?;
        Ok(result)
    }

    fn buffer(&self, bytes: usize) -> Result<Owned> {
        // SAFETY: the device is there.
        let object = unsafe { (self.library.functions.new_buffer)(self.object, bytes) };
        let buffer = Owned { object, release: self.library.functions.release_buffer };
        self.check("make a buffer")?;
        Ok(buffer)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        if !self.object.is_null() {
            // SAFETY: it is there, and nothing uses it any more.
            unsafe { (self.library.functions.release_device)(self.object) };
        }
    }
}

/// A filter or buffer that is released at its end.
struct Owned {
    object: Object,
    release: unsafe extern "C" fn(Object),
}

impl Drop for Owned {
    fn drop(&mut self) {
        if !self.object.is_null() {
            // SAFETY: it is there, and nothing uses it any more: a filter holds on to its buffers by itself.
            unsafe { (self.release)(self.object) };
        }
    }
}
