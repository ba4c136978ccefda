# CPack runs this on the installed trees: documents as Debian wants them (Policy 12.1, 12.5, 12.7).
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)

function(write_documents doc package)
  file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/copyright ${doc}/copyright)
  file(WRITE ${doc}/changelog.Debian
"${package} (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * What a user notices is in ${CPACK_PACKAGE_NAME}'s changelog.gz.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  execute_process(COMMAND gzip -9nf ${doc}/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(usr ${CPACK_TEMPORARY_DIRECTORY}/Unspecified/usr)
set(doc ${usr}/share/doc/${CPACK_PACKAGE_NAME})
file(RENAME ${doc}/CHANGELOG.md ${doc}/changelog)
file(REMOVE ${doc}/LICENSE)
file(GLOB pages ${usr}/share/man/man*/*.[1-8])
execute_process(COMMAND gzip -9nf ${pages} ${doc}/changelog COMMAND_ERROR_IS_FATAL ANY)
write_documents(${doc} ${CPACK_PACKAGE_NAME})

set(usr ${CPACK_TEMPORARY_DIRECTORY}/calibration/usr)
if(EXISTS ${usr})
  set(package ${CPACK_PACKAGE_NAME}-calibration)
  file(MAKE_DIRECTORY ${usr}/share/doc/${package})
  write_documents(${usr}/share/doc/${package} ${package})
endif()
