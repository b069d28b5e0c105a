# SPDX-License-Identifier: Apache-2.0
"""The messages of the API, made from proto/curvecast/v1/curvecast.proto when the package is built."""
