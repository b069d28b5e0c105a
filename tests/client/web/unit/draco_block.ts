// A block of 48 points on a cow, as the server encodes it.

export const dracoBlock = {
  count: 48,
  radius: 0.4701379,
  data: Uint8Array.from(
    atob(
      "RFJBQ08CAwAAAAAwAAAAAQMACQMAAAEJAwABBAIBAAICAwEAAQEAETdVCa0uAQgJ/ANWoznLrh+J/BCkaguIxpctgB3WpRAJ9SB4c7XZwW/fI2T7" +
        "Aa8v2ksAFUa3IN0gszVYGeM1mSAr74tmoZ2hAExN8GTItDEqnca7wCmAIEFdcCEccL6M4BZSTxfmQ5TeBT66NL1gzJi1U1VPLCEGcf+Vb8nB4DMe" +
        "uxBVTcv/RlQoSutPewcdNnjTKsDWnuzA7rKgXI7kY1zoii1k0Hvf6utVwJ+p4080fxBggId1Yal6p3SMWQ3G3HVJ4vgTJ/tKrRE9p2lNY5ML4xjL" +
        "iTR4/MiIBqgLSZw4UDQbqE0H5ZPDUKOUViVIyTUtHkXzAMpgNqExAGl7ISxkmvbuFyTu+i2TEEVY3+AJ69uhq9RCHjyKGGO9YAISAAAAAP//AAAA" +
        "AwEACxtVAQEMrQYBLAqq70dCDlKJv+6Is2/QbRtdqM+qv8+PuGLh3xpbBEZ8hecAp/9rM3A+BTit+9HCR1XXUHbT8Dv5sSMRt8Sip5BUADiv0Vmk" +
        "NeoKMR3Nlzz57Lx6f5P0I5DxrqAET29r9OqJffRb14dIgx8hkNe016MHnrNpCQhlQJq3UuoM/wMAAP8BAAAAAQEBAQEBQAEAAAAAAAAAAADAEM2+" +
        "wrouv/A9Kr9MEd0/EAo=",
    ),
    (c) => c.charCodeAt(0),
  ),
  /// x, y, z, and the unit normal, before they were quantised.
  first: [-0.34322, -0.3228, 0.60319, -0.98114, -0.18241, 0.06421],
  last: [-0.29746, 0.0491, 0.04065, -0.76635, 0.39842, -0.50398],
};
