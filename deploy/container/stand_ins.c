// What libcurl asks of librtmp and libldap, for addresses that nobody gives it here: nothing is ever called. Debian's own bring
// GnuTLS and its libraries, a tenth of the image. libcurl is the only one that looks for them, when the command starts.
//
//   gcc -shared -DRTMP -Wl,-soname,librtmp.so.1 ...
//   gcc -shared -DLDAP -Wl,-soname,libldap-2.5.so.0 ... with all symbols of the version OPENLDAP_2.5
#define FAILS(function) \
  int function(void) { return -1; }
#define HAS_NONE(function) \
  void *function(void) { return 0; }

#ifdef RTMP
HAS_NONE(RTMP_Alloc)
FAILS(RTMP_Close)
FAILS(RTMP_Connect1)
FAILS(RTMP_ConnectStream)
FAILS(RTMP_Free)
FAILS(RTMP_Init)
FAILS(RTMP_Read)
FAILS(RTMP_SetBufferMS)
FAILS(RTMP_SetupURL)
FAILS(RTMP_Write)
#endif

#ifdef LDAP
HAS_NONE(ldap_err2string)
FAILS(ldap_abandon_ext)
FAILS(ldap_free_urldesc)
FAILS(ldap_get_attribute_ber)
FAILS(ldap_get_dn_ber)
FAILS(ldap_get_option)
FAILS(ldap_init_fd)
FAILS(ldap_memfree)
FAILS(ldap_msgfree)
FAILS(ldap_msgtype)
FAILS(ldap_parse_result)
FAILS(ldap_parse_sasl_bind_result)
FAILS(ldap_pvt_url_scheme2proto)
FAILS(ldap_result)
FAILS(ldap_sasl_bind)
FAILS(ldap_search_ext)
FAILS(ldap_set_option)
FAILS(ldap_start_tls)
FAILS(ldap_unbind_ext)
FAILS(ldap_url_parse)
#endif
